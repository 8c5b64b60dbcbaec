#include "drivers/device/exposure_clock.hpp"

#include <algorithm>

namespace compueye::device {

void ExposureClock::begin(std::int64_t start_ns, std::int64_t period_ns) noexcept {
  *this = {};
  origin_ns_ = start_ns;
  period_ns_ = std::max<std::int64_t>(period_ns, 1);
}

void ExposureClock::saw_frame(std::uint64_t device_frame, std::int64_t now_ns, bool waited_for) noexcept {
  std::int64_t ready_ns = 0;
  if (device_frame >= static_cast<std::uint64_t>(none) ||
      __builtin_mul_overflow(static_cast<std::int64_t>(device_frame) + 1, period_ns_, &ready_ns) ||
      __builtin_add_overflow(ready_ns, origin_ns_, &ready_ns)) {
    return;  // no device has run for so long
  }
  std::int64_t late_ns = now_ns - ready_ns;
  if (late_ns < 0) {
    origin_ns_ += late_ns;
    late_ns = 0;
  }
  if (!waited_for) return;
  least_in_window_ns_ = std::min(least_in_window_ns_, late_ns);
  if (++in_window_ < window) return;
  if (least_late_ns_ != none && least_in_window_ns_ > least_late_ns_) {
    origin_ns_ += least_in_window_ns_ - least_late_ns_;
  } else {
    least_late_ns_ = least_in_window_ns_;
  }
  least_in_window_ns_ = none;
  in_window_ = 0;
}

std::uint64_t ExposureClock::exposed_before(std::int64_t t_ns) const noexcept {
  return t_ns <= origin_ns_ ? 0 : static_cast<std::uint64_t>((t_ns - origin_ns_ - 1) / period_ns_);
}

}  // namespace compueye::device
