#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace compueye::calib {

/// When a frame's exposure began on the host's clock, at the latest: device time plus the least way that any frame took
/// so far. A device whose time goes back began anew. A frame without a time of its own counts from when it came.
class FrameTime {
 public:
  [[nodiscard]] std::int64_t begun_ns(std::int64_t device_ns, bool time_ok, std::int64_t came_ns) noexcept {
    if (!time_ok) return came_ns;
    if (device_ns < last_device_ns_) least_way_ns_ = std::numeric_limits<std::int64_t>::max();
    last_device_ns_ = device_ns;
    least_way_ns_ = std::min(least_way_ns_, came_ns - device_ns);
    return device_ns + least_way_ns_;
  }

 private:
  std::int64_t last_device_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t least_way_ns_ = std::numeric_limits<std::int64_t>::max();
};

}  // namespace compueye::calib
