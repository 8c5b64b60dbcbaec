#include "tests/hil/emulated_hidraw.hpp"

#include <linux/hidraw.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

#include "drivers/protocol/hid_report.hpp"

namespace compueye::hil {
namespace {

using protocol::DeviceEmulator;

constexpr auto poll_interval = std::chrono::milliseconds(1);
constexpr unsigned send_feature_number = _IOC_NR(HIDIOCSFEATURE(0));
constexpr unsigned get_feature_number = _IOC_NR(HIDIOCGFEATURE(0));

}  // namespace

EmulatedHidraw::EmulatedHidraw(EmulatedCable& cable, std::function<void(bool)> set_ready)
    : cable_(cable),
      set_ready_(std::move(set_ready)),
      attachment_(cable.attachment()),
      poller_([this] { poll_device(); }) {}

EmulatedHidraw::~EmulatedHidraw() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  poller_.join();
}

template <class Use>
EmulatedHidraw::Transfer EmulatedHidraw::when_there(Use&& use) {
  return cable_.with([&](DeviceEmulator& device, std::int64_t now_ns) -> Transfer {
    if (!device.attached(now_ns) || device.attachment(now_ns) != attachment_) {
      return {DeviceEmulator::Outcome::gone, 0};
    }
    return use(device, now_ns);
  });
}

void EmulatedHidraw::poll_device() {
  std::unique_lock lock(mutex_);
  while (!stopping_ && !gone_) {
    gone_ = !take_reports();
    if (gone_ || !reports_.empty()) set_ready_(true);
    changed_.wait_for(lock, poll_interval);
  }
}

/// Queues what the device has; false when it has gone. A halted endpoint is usbhid's business: it looks like silence.
bool EmulatedHidraw::take_reports() {
  for (;;) {
    if (!may_overflow_ && reports_.size() == queue_reports) return true;
    std::array<std::byte, protocol::hid_report_bytes> report{};
    const Transfer transfer =
        when_there([&](DeviceEmulator& device, std::int64_t now_ns) { return device.read(now_ns, report); });
    if (transfer.outcome == DeviceEmulator::Outcome::gone) return false;
    if (transfer.outcome != DeviceEmulator::Outcome::done) return true;
    if (reports_.size() == queue_reports) {
      ++counters_.dropped;
      continue;
    }
    reports_.emplace_back(report.begin(), report.begin() + static_cast<std::ptrdiff_t>(transfer.bytes));
    ++counters_.queued;
    counters_.most_queued = std::max<std::uint64_t>(counters_.most_queued, reports_.size());
  }
}

void EmulatedHidraw::opened() {
  const std::lock_guard lock(mutex_);
  reports_.clear();
  if (!gone_) set_ready_(false);
}

EmulatedHidraw::Answer EmulatedHidraw::read(std::span<std::byte> into) {
  const std::lock_guard lock(mutex_);
  if (read_errors_ > 0) {
    --read_errors_;
    return {-1, read_error_};
  }
  if (reports_.empty()) {
    if (gone_) return {-1, EIO};
    set_ready_(false);
    return {-1, EAGAIN};
  }
  const std::vector<std::byte>& report = reports_.front();
  const std::size_t bytes = std::min(report.size(), into.size());
  std::copy_n(report.begin(), bytes, into.begin());
  reports_.pop_front();
  if (reports_.empty() && !gone_) set_ready_(false);
  return {static_cast<long>(bytes), 0};
}

EmulatedHidraw::Answer EmulatedHidraw::feature(const Transfer& transfer, std::size_t bytes) {
  switch (transfer.outcome) {
    case DeviceEmulator::Outcome::done:
      return {static_cast<long>(bytes), 0};
    case DeviceEmulator::Outcome::stalled:
      return {-1, EPIPE};
    case DeviceEmulator::Outcome::gone:
      return {-1, ENODEV};
    case DeviceEmulator::Outcome::nothing:
      break;
  }
  std::this_thread::sleep_for(request_timeout);
  return {-1, ETIMEDOUT};
}

EmulatedHidraw::Answer EmulatedHidraw::ioctl(unsigned long request, void* argument) {
  const auto& descriptor = protocol::hid_report_descriptor;
  if (request == HIDIOCGRDESCSIZE) {
    *static_cast<int*>(argument) = static_cast<int>(descriptor.size());
    return {};
  }
  if (request == HIDIOCGRDESC) {
    auto& out = *static_cast<hidraw_report_descriptor*>(argument);
    std::copy_n(descriptor.begin(), std::min<std::size_t>(descriptor.size(), out.size), out.value);
    return {};
  }
  const auto number = static_cast<unsigned>(_IOC_NR(request));
  const std::span report(static_cast<std::byte*>(argument), _IOC_SIZE(request));
  if (_IOC_TYPE(request) != 'H' || report.empty()) return {-1, ENOTTY};
  if (number == send_feature_number) {
    return feature(
        when_there([&](DeviceEmulator& device, std::int64_t now_ns) { return device.set_feature(now_ns, report); }),
        report.size());
  }
  if (number == get_feature_number) {
    const auto id = std::to_integer<std::uint8_t>(report[0]);
    const Transfer transfer =
        when_there([&](DeviceEmulator& device, std::int64_t now_ns) { return device.get_feature(now_ns, id, report); });
    return feature(transfer, transfer.bytes);
  }
  return {-1, ENOTTY};
}

void EmulatedHidraw::let_overflow() {
  const std::lock_guard lock(mutex_);
  may_overflow_ = true;
}

void EmulatedHidraw::fail_reads(int error, int count) {
  const std::lock_guard lock(mutex_);
  read_error_ = error;
  read_errors_ = count;
  set_ready_(true);
}

EmulatedHidraw::Counters EmulatedHidraw::counters() {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace compueye::hil
