#include "firmware/pipeline/device_time.hpp"

#include <algorithm>

namespace compueye::firmware {

std::int64_t DeviceTime::exposure_start_ns(const hal::SampleBlock& block, std::int64_t received_ns) noexcept {
  if (!block.flags.time_ok || block.t_ns < last_t_ns_) {
    // The device clock was set or restarted: the old offset says nothing about the new one.
    smallest_now_ = smallest_before_ = unknown;
    in_half_ = 0;
  }
  if (!block.flags.time_ok) return received_ns - period_ns_;
  if (relation_ == DeviceClock::host) return block.t_ns;

  last_t_ns_ = block.t_ns;
  if (in_half_ == half_window) {
    smallest_before_ = smallest_now_;
    smallest_now_ = unknown;
    in_half_ = 0;
  }
  ++in_half_;
  smallest_now_ = std::min(smallest_now_, received_ns - block.t_ns);
  return block.t_ns + std::min(smallest_now_, smallest_before_) - period_ns_;
}

}  // namespace compueye::firmware
