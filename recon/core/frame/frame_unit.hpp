#pragma once

#include <bit>
#include <cstdint>

#include "recon/core/frame/frame_info.hpp"

namespace compueye::recon::core {

/// Powers of two between what goes in and out and what a frame is solved in, so that its squares stay clear of the ends
/// of float32 whatever y, x and A are measured in. They change no digit.
struct FrameUnit {
  double samples = 1.0;  ///< y times this is solved for
  double picture = 1.0;  ///< what is found times this is x

  /// The same for samples that are `by` times as large.
  [[nodiscard]] constexpr FrameUnit for_samples_times(double by) const noexcept { return {samples * by, picture / by}; }

  /// Brings figures back to the units of y and x. `of_norm`: the objective is one of x alone.
  constexpr void restore(FrameInfo& info, bool of_norm) const noexcept {
    const double value = of_norm ? picture : 1.0 / (samples * samples);
    info.objective *= value;
    info.residual /= samples;
    if (info.duality_gap > 0.0) info.duality_gap *= value;
  }
};

/// The power of two that brings a size to 1 .. 2; 1 for nought and what is not finite.
[[nodiscard]] constexpr double power_to_one(double size) noexcept {
  const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(size) >> 52U) & 0x7FFU;
  if (exponent == 0 || exponent >= 0x7FEU) return 1.0;
  return std::bit_cast<double>((0x7FEU - exponent) << 52U);
}

}  // namespace compueye::recon::core
