#pragma once

#include <cstdint>
#include <vector>

#include "hal/result.hpp"

namespace compueye::hal {

/// The photodiodes of an eye and their converter: how photocurrent becomes codes.
/// code = dark_level_lsb + y / lsb() + noise, rounded and clipped to 0 .. 2^bits - 1. One unit of y is what a fully
/// seen pixel at white gives.
struct SensorSettings {
  int bits = 16;                   ///< 1 .. 24
  double full_scale = 4096.0;      ///< y of 2^bits LSB above the dark level, > 0
  double read_noise_lsb = 0.0;     ///< standard deviation of a Gaussian, a draw for each channel and frame, >= 0
  double dark_level_lsb = 0.0;     ///< code without light, >= 0 and below 2^bits
  std::vector<int> dead = {};      ///< channels that never tell anything, ascending, distinct, 0 .. M-1
  double saturation_share = 1.0;   ///< a code at or above this share of the highest one counts as saturated, (0, 1]
  double max_missing_share = 0.0;  ///< a frame lacking more of its seeing channels (dead included) is invalid, [0, 1]

  /// One code step in units of y: full_scale / 2^bits.
  [[nodiscard]] double lsb() const noexcept;
  [[nodiscard]] std::int32_t largest_code() const noexcept { return (std::int32_t{1} << bits) - 1; }
  /// Standard deviation of y from read noise and rounding: lsb * sqrt(read_noise_lsb^2 + 1/12).
  [[nodiscard]] double noise_sigma() const noexcept;
  /// Whether the converter can be: bits, full scale, dark level and noise. Error out_of_range names the field, its
  /// value and its range. What depends on the eye (`dead`) or on a policy (the shares) is for their users to judge.
  [[nodiscard]] Result<void> validate() const;
};

}  // namespace compueye::hal
