#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "tests/hil/emulated_cable.hpp"

namespace compueye::hil {

/// Linux's side of one plugging-in of a HID eye: drivers/hid/hidraw.c and usbhid over the emulated eye. A thread polls
/// the interrupt endpoint as a host controller does, but leaves the eye's reports where they are while the queue is
/// full: a client on a busy machine would lose some. For clients of this process.
class EmulatedHidraw {
 public:
  static constexpr std::size_t queue_reports = 64;  ///< HIDRAW_BUFFER_SIZE
  /// The kernel waits five seconds for an answer to a request; here it is in a hurry.
  static constexpr auto request_timeout = std::chrono::milliseconds(50);

  struct Answer {
    long result = 0;  ///< of read() or ioctl(): 0 or more, or -1
    int error = 0;    ///< then errno
  };
  struct Counters {
    std::uint64_t queued = 0, dropped = 0, most_queued = 0;
  };

  /// `set_ready` makes the device file readable or not; it is called under a lock.
  EmulatedHidraw(EmulatedCable& cable, std::function<void(bool)> set_ready);
  ~EmulatedHidraw();
  EmulatedHidraw(const EmulatedHidraw&) = delete;
  EmulatedHidraw& operator=(const EmulatedHidraw&) = delete;

  Answer read(std::span<std::byte> into);
  Answer ioctl(unsigned long request, void* argument);
  /// A program opened the file: it sees reports from now on.
  void opened();

  /// From now on a report for which the queue has no room is lost, as Linux loses it.
  void let_overflow();
  /// The next reads fail so.
  void fail_reads(int error, int count = 1);
  [[nodiscard]] Counters counters();

 private:
  using Transfer = protocol::DeviceEmulator::Transfer;
  template <class Use>
  Transfer when_there(Use&& use);
  void poll_device();
  bool take_reports();
  Answer feature(const Transfer& transfer, std::size_t bytes);

  EmulatedCable& cable_;
  std::function<void(bool)> set_ready_;
  std::uint64_t attachment_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<std::byte>> reports_;
  int read_error_ = 0, read_errors_ = 0;
  bool gone_ = false, stopping_ = false, may_overflow_ = false;
  Counters counters_;
  std::thread poller_;
};

}  // namespace compueye::hil
