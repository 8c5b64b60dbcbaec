#include "tests/hil/converters_in_time.hpp"

#include <cerrno>
#include <chrono>
#include <optional>
#include <utility>

namespace compueye::hil {
namespace {

// How late the emulated interrupt may be; its edge has the time of the conversion all the same.
constexpr auto edge_pause = std::chrono::microseconds(200);

}  // namespace

ConvertersInTime::ConvertersInTime(frontend::EmulatedFrontEndSettings settings,
                                   std::function<void(std::int64_t t_ns)> at_edge)
    : front_end_(std::move(settings), clock_.now_ns()),
      at_edge_(std::move(at_edge)),
      edges_([this] { pass_edges(); }) {}

ConvertersInTime::~ConvertersInTime() {
  stopping_ = true;
  edges_.join();
}

void ConvertersInTime::inject(frontend::FrontEndFault fault) {
  const std::lock_guard lock(mutex_);
  fault.at_ns = clock_.now_ns();
  front_end_.inject(fault);
}

void ConvertersInTime::select(std::uint32_t chip) {
  const std::lock_guard lock(mutex_);
  front_end_.select(chip);
}

void ConvertersInTime::reset_level(bool high) {
  const std::lock_guard lock(mutex_);
  front_end_.reset_level(high, clock_.now_ns());
}

void ConvertersInTime::Bus::transfer(std::span<const hal::SpiSegment> segments) {
  if (!settings && of.before_exchange) of.before_exchange();
  const std::lock_guard lock(of.mutex_);
  const std::int64_t now_ns = of.clock_.now_ns();
  const auto ended =
      settings ? of.front_end_.exchange_settings(segments, now_ns) : of.front_end_.exchange(segments, now_ns);
  outcome_ = ended == frontend::EmulatedFrontEnd::Outcome::failed ? EIO : 0;
}

/// ESHUTDOWN while the files are gone, as the kernel has it for those that are open.
int ConvertersInTime::Bus::status() {
  const std::lock_guard lock(of.mutex_);
  return of.front_end_.present(of.clock_.now_ns()) ? 0 : ESHUTDOWN;
}

void ConvertersInTime::pass_edges() {
  while (!stopping_) {
    for (;;) {
      std::optional<hal::Edge> edge;
      {
        const std::lock_guard lock(mutex_);
        edge = front_end_.take_edge(clock_.now_ns());
      }
      if (!edge) break;
      at_edge_(edge->t_ns);
    }
    std::this_thread::sleep_for(edge_pause);
  }
}

}  // namespace compueye::hil
