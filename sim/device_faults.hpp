#pragma once

#include <cstdint>
#include <vector>

#include "hal/result.hpp"

namespace compueye::sim {

/// A channel that is reported invalid, with a meaningless mid-scale code, from a frame on.
struct InvalidChannel {
  int channel = 0;
  std::uint64_t from_frame = 0;
};

/// What goes wrong with a simulated device, scripted by frame number and the same after every start().
struct DeviceFaults {
  std::vector<InvalidChannel> invalid_channels;
  /// Frames that are lost on the way: their numbers are used up and no overrun is flagged. Any order, no repeats.
  std::vector<std::uint64_t> lost_frames;

  /// Errors: out_of_range (a channel outside 0 .. channels - 1), usage (a frame listed twice).
  [[nodiscard]] hal::Result<void> validate(int channels) const;
};

}  // namespace compueye::sim
