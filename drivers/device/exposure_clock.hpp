#pragma once

#include <cstdint>
#include <limits>

namespace compueye::device {

/// How many frames of a stream a device has exposed by a time of the host: for the time when it can no longer be asked.
///
/// Frames are complete one period after the other from START on. The two clocks drift apart, so the estimate follows
/// the arrivals: a frame that comes before its time moves it back, and when the least late of `window` frames that were
/// waited for is later than the least late before, the device is slow and it moves on. It is right to the latency of
/// the transport, so to one frame where that is less than a period; before the first frames, to the delay of START (10
/// ms at most).
class ExposureClock {
 public:
  void begin(std::int64_t start_ns, std::int64_t period_ns) noexcept;
  /// `waited_for`: it came while the host waited; otherwise the host was late and may have found it at any time after.
  void saw_frame(std::uint64_t device_frame, std::int64_t now_ns, bool waited_for) noexcept;
  /// Frames that were complete before `t_ns`.
  [[nodiscard]] std::uint64_t exposed_before(std::int64_t t_ns) const noexcept;

 private:
  static constexpr int window = 64;
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();

  std::int64_t period_ns_ = 1;
  std::int64_t origin_ns_ = 0;  // start of exposure of frame 0
  std::int64_t least_late_ns_ = none, least_in_window_ns_ = none;
  int in_window_ = 0;
};

}  // namespace compueye::device
