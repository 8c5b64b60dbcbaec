#include "sim/device_faults.hpp"

#include <algorithm>
#include <string>

namespace compueye::sim {

hal::Result<void> DeviceFaults::validate(int channels) const {
  for (const InvalidChannel& fault : invalid_channels) {
    if (fault.channel >= 0 && fault.channel < channels) continue;
    return hal::fail(hal::ErrorCode::out_of_range, "faults.invalid_channels",
                     "channel is " + std::to_string(fault.channel) + ", expected 0 to " + std::to_string(channels - 1));
  }
  std::vector<std::uint64_t> sorted = lost_frames;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice == sorted.end()) return {};
  return hal::fail(hal::ErrorCode::usage, "faults.lost_frames",
                   "frame " + std::to_string(*twice) + " is listed twice, expected every frame once at most");
}

}  // namespace compueye::sim
