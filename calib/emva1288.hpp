#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/result.hpp"

namespace compueye::calib {

/// Frames taken one after the other under one light.
struct LightSeries {
  double light = 0.0;               ///< proportional to the photons of a frame, in any unit; 0: dark
  double exposure_s = 0.0;          ///< integration time, > 0
  std::vector<std::int32_t> codes;  ///< frames x M, a frame a row; at least 2 frames
};

/// Of one channel. Nothing where the frames cannot tell.
struct ChannelNoise {
  std::optional<double> gain_lsb_per_e;  ///< K, the system gain
  std::optional<double> dark_noise_lsb;  ///< temporal noise in the dark at the shortest exposure, rounding included
  std::optional<double> read_noise_e;    ///< temporal noise in the dark at the shortest exposure
  std::optional<double> dark_current_e_per_s;
  std::optional<double> saturation_e;     ///< where the temporal variance is largest, as near as the series are close
  std::optional<double> linearity_error;  ///< mean relative distance from a line over 5 .. 95 % of saturation
  std::optional<double> dynamic_range;    ///< saturation over the absolute sensitivity threshold
};

struct SensorNoise {
  std::vector<ChannelNoise> channels;  ///< M
  ChannelNoise median;                 ///< of those that can be told, where that is more than half
  std::optional<double> dsnu_e;        ///< spread of dark means over the channels, temporal noise taken off
  /// Relative spread of means at half saturation, temporal noise taken off. What the optics make unlike (areas seen,
  /// vignetting, dust) is in it: it is the sensor's own only before an even source without optics.
  std::optional<double> prnu;
};

/// What noise, gains and offsets a sensor has, by the photon transfer of EMVA Standard 1288, release 4.0 Linear (2021):
/// K is the slope, through the origin, of the temporal variance over the mean, both less the dark ones, up to 70 % of
/// saturation. `series`: flats at rising light and one exposure, darks of that exposure and, for the dark current, of
/// at least one other. One temperature: two are two calls.
///
/// A lamp's noise moves all channels together and would count as their own (0.1 % makes K 1.9 times too large at 500
/// electrons per LSB). So the share of each frame that is proportional to the mean picture is taken off before
/// variances are, and they are divided by what that leaves of independent noise (1 - 1/M for channels alike); channels
/// that vary thirty times as much as the median one (that blink) have no part in saying what that share is. K needs at
/// least two channels, and is not told where it is not three standard errors above 0; the median K is told also where
/// few frames let no single channel's be, since all of them together know it better.
///
/// Errors: usage (no series), out_of_range (channels, bits 1 .. 24, light or exposure), mismatch (codes are not whole
/// frames, fewer than two, no dark of the flats' exposure, flats of several exposures).
[[nodiscard]] hal::Result<SensorNoise> sensor_noise(std::span<const LightSeries> series, int channels, int bits);

}  // namespace compueye::calib
