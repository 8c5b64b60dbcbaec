#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>

#include "hal/illuminator.hpp"

namespace compueye::illuminator {

/// The level, 0 .. levels - 1, of a linear intensity; NaN is dark.
[[nodiscard]] inline int level_of(float intensity, int levels) noexcept {
  if (!(intensity > 0.0F)) return 0;
  const float top = static_cast<float>(levels - 1);
  return static_cast<int>(std::lround(intensity < 1.0F ? intensity * top : top));
}

/// Error mismatch: not as many intensities as the light has pixels.
[[nodiscard]] inline hal::Result<void> check_size(const hal::IlluminatorDescription& light,
                                                  std::span<const float> intensities, const char* place) {
  const auto pixels = static_cast<std::size_t>(light.rows) * static_cast<std::size_t>(light.cols);
  if (intensities.size() == pixels) return {};
  return hal::fail(
      hal::ErrorCode::mismatch, place,
      "is given " + std::to_string(intensities.size()) + " intensities, expected " + std::to_string(pixels));
}

}  // namespace compueye::illuminator
