#pragma once

#include <cstddef>
#include <vector>

#include "calib/estimate/captures.hpp"
#include "calib/estimate/status_limits.hpp"

namespace compueye::calib {

/// What the patterns gave, in fully seen white pixels: codes straightened, dark levels off, the lamp's drift divided
/// out.
///
/// The lamp is one for all channels, so its factor at each reference is fitted to all channels at once (their noise
/// then hardly counts) and is interpolated linearly between references; 1 is the mean of the references. A dark level
/// is the channel's mean over the darks, plus what all channels moved by together, interpolated: single darks would
/// hand their noise on to the patterns around them.
struct LightSamples {
  int patterns = 0, channels = 0;
  std::vector<double> light;           ///< patterns x channels; NaN: none
  std::vector<double> fixed_variance;  ///< patterns: read noise and rounding of one sample, units^2
  std::vector<double> light_variance;  ///< patterns: what one unit of light adds to it
  std::vector<double> lamp;            ///< patterns: the factor that was divided out
  std::vector<double> dark_lsb;        ///< channels, mean
  std::vector<double> white;           ///< channels: mean of the references, or of the patterns where there are none
  std::vector<ChannelStatus> status;   ///< channels: good, hot, noisy or saturated

  [[nodiscard]] double at(std::size_t pattern, std::size_t channel) const noexcept {
    return light[pattern * static_cast<std::size_t>(channels) + channel];
  }
};

/// Of captures that are valid.
[[nodiscard]] LightSamples light_samples(const Captures& captures, const CodeNoise& noise, int channels, int pixels,
                                         const StatusLimits& limits);

}  // namespace compueye::calib
