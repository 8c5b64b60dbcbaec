#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace compueye::calib {

/// When a frame's exposure began on the host's clock, at the latest: device time plus the least way that any frame took
/// of late. A device whose time goes back began anew. A frame without a time of its own counts from when it came.
///
/// The device's clock runs at its own rate. Where it is fast, ways become shorter by themselves; where it is slow they
/// become longer, and a least one of long ago would make frames seem ever older, and have them passed over for ever
/// longer. So only the last one to two stretches count, each of ten seconds and a hundred frames: long enough that
/// frames which were held up never stand alone in them.
class FrameTime {
 public:
  static constexpr std::int64_t stretch_ns = 10'000'000'000;
  static constexpr int stretch_frames = 100;

  [[nodiscard]] std::int64_t begun_ns(std::int64_t device_ns, bool time_ok, std::int64_t came_ns) noexcept {
    if (!time_ok) return came_ns;
    if (device_ns < last_device_ns_) least_before_ns_ = least_ns_ = none;
    last_device_ns_ = device_ns;
    if (++frames_ > stretch_frames && came_ns - since_ns_ > stretch_ns) {
      least_before_ns_ = least_ns_;
      least_ns_ = none;
      frames_ = 1;
      since_ns_ = came_ns;
    }
    least_ns_ = std::min(least_ns_, came_ns - device_ns);
    return device_ns + std::min(least_ns_, least_before_ns_);
  }

 private:
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();

  std::int64_t last_device_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t least_ns_ = none, least_before_ns_ = none;  // ways in this stretch, in the one before
  std::int64_t since_ns_ = 0;
  int frames_ = 0;
};

}  // namespace compueye::calib
