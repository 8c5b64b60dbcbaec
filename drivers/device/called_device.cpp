#include "drivers/device/called_device.hpp"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

namespace compueye::device {
namespace {

// What is read ahead of its being asked for is not waited for longer than this, so that something else that is wanted
// has its turn; requests of an eye have as long.
constexpr std::int64_t ahead_ns = 100'000'000;

}  // namespace

/// One of the rows, with what goes wrong beside errors.
template <class Run>
AsideCall CalledDevice::row(DeviceCall which, Run run) {
  return {limit_of(which).name, [this, run](AsideBell& bell) {
            try {
              run(*this, bell);
            } catch (const std::exception&) {
              done = ended = hal::fail(hal::ErrorCode::no_space, "device", "out of memory");
            }
            note_books();
          }};
}

CalledDevice::CalledDevice(std::shared_ptr<hal::Clock> by)
    : clock(std::move(by)),
      calls{
          row(DeviceCall::open,
              [](CalledDevice& d, AsideBell&) {
                auto opened = d.open(*d.clock);
                d.done = opened ? hal::Result<void>() : tl::unexpected(std::move(opened.error()));
                if (opened) d.source = std::move(*opened);
              }),
          // One that somebody went on without may have started it, or not have stopped it.
          row(DeviceCall::start,
              [](CalledDevice& d, AsideBell&) {
                d.source->stop();
                d.done = d.source->start();
              }),
          row(DeviceCall::read, [](CalledDevice& d, AsideBell& bell) { d.read(bell); }),
          row(DeviceCall::set, [](CalledDevice& d, AsideBell&) { d.done = std::exchange(d.act, nullptr)(*d.source); }),
          row(DeviceCall::stop, [](CalledDevice& d, AsideBell&) { d.source->stop(); }),
      } {}

void CalledDevice::note_books() noexcept {
  if (source) books = {source->account(), source->outages(), source->withheld()};
}

/// Until the deadline that was asked for last, the ring is full, or something else is wanted.
void CalledDevice::read(AsideBell& bell) {
  ended = {};
  std::int64_t until_ns = deadline_ns.load(std::memory_order_relaxed);
  for (;;) {
    read_due_ns.store(until_ns, std::memory_order_relaxed);
    read_since_ns.store(clock->now_ns(), std::memory_order_relaxed);
    const auto block = source->read(until_ns);
    const bool timed_out = !block && block.error().code == hal::ErrorCode::timeout;
    if (!block && !timed_out) {
      ended = tl::unexpected(block.error());
      return;
    }
    if (block) {
      note_books();
      if (!ring->push(*block, books)) {
        ended = hal::fail(hal::ErrorCode::bad_format, source->describe().serial,
                          "gave a frame of " + std::to_string(block->codes.size()) + " channels, expected " +
                              std::to_string(source->describe().channels));
        return;
      }
      if (!ring->has_room() || wanted.load(std::memory_order_relaxed)) return;
      bell.ring();
    }
    const std::int64_t now_ns = clock->now_ns(), last_ns = deadline_ns.load(std::memory_order_relaxed);
    if (now_ns >= last_ns || wanted.load(std::memory_order_relaxed)) {
      if (timed_out) ended = hal::timed_out();
      return;
    }
    until_ns = std::min(last_ns, now_ns + ahead_ns);
  }
}

}  // namespace compueye::device
