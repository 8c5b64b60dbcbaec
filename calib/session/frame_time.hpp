#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace compueye::calib {

/// When a frame's exposure began on the host's clock, at the latest: device time plus the least way that any frame took
/// so far. A device whose time goes back began anew. A frame without a time of its own counts from when it came.
///
/// The device's clock runs at its own rate. Where it is fast, ways become shorter by themselves; where it is slow they
/// become longer, so that the least one is let go by as much as a clock may be off: else frames would seem ever older,
/// and be passed over for ever longer.
class FrameTime {
 public:
  static constexpr std::int64_t most_drift = 400;  ///< one part in so many; USB allows a device 2500 in a million

  [[nodiscard]] std::int64_t begun_ns(std::int64_t device_ns, bool time_ok, std::int64_t came_ns) noexcept {
    if (!time_ok) return came_ns;
    if (device_ns < last_device_ns_) least_way_ns_ = std::numeric_limits<std::int64_t>::max();
    const std::int64_t passed_ns = std::max<std::int64_t>(came_ns - last_came_ns_, 0);
    if (least_way_ns_ != std::numeric_limits<std::int64_t>::max()) least_way_ns_ += passed_ns / most_drift;
    last_device_ns_ = device_ns;
    last_came_ns_ = came_ns;
    least_way_ns_ = std::min(least_way_ns_, came_ns - device_ns);
    return device_ns + least_way_ns_;
  }

 private:
  std::int64_t last_device_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t last_came_ns_ = 0;
  std::int64_t least_way_ns_ = std::numeric_limits<std::int64_t>::max();
};

}  // namespace compueye::calib
