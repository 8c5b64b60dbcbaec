#pragma once

#include <cstdint>
#include <limits>

#include "hal/sample_block.hpp"

namespace compueye::firmware {

/// How the time stamps of a source relate to the host clock.
enum class DeviceClock : std::uint8_t {
  host,          ///< t_ns is on the very Clock the pipeline runs on (simulator, replay)
  free_running,  ///< the device's own origin and drift
};

/// Start of exposure on the host clock.
///
/// With a free-running device clock the offset is taken from the frame of the last 256 to 512 that travelled fastest,
/// which is assumed to have arrived one frame period after its exposure began (a frame cannot be complete earlier while
/// the sensor integrates without pause). The window bounds what drift can add: 100 ppm over 512 frames at 100 Hz is
/// 0.5 ms. Without a trusted time stamp (flags.time_ok false) the exposure is taken to begin one period before arrival,
/// and the offset is learnt anew: the clock was set.
class DeviceTime {
 public:
  DeviceTime(DeviceClock relation, double frame_rate_hz) noexcept
      : relation_(relation),
        period_ns_(frame_rate_hz > 0.0 ? static_cast<std::int64_t>(1e9 / frame_rate_hz) : std::int64_t{0}) {}

  [[nodiscard]] std::int64_t exposure_start_ns(const hal::SampleBlock& block, std::int64_t received_ns) noexcept;

 private:
  static constexpr int half_window = 256;
  static constexpr std::int64_t unknown = std::numeric_limits<std::int64_t>::max();

  DeviceClock relation_;
  std::int64_t period_ns_;
  std::int64_t last_t_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t smallest_now_ = unknown;     // smallest received - t_ns of the current half window
  std::int64_t smallest_before_ = unknown;  // ... and of the one before
  int in_half_ = 0;
};

}  // namespace compueye::firmware
