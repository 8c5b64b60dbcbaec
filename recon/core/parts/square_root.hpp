#pragma once

namespace compueye::recon::core {

/// sqrt by Newton's iteration instead of libm: the core links no mathematical library and gives the same bits
/// everywhere. 0 for zero and negative values; NaN stays NaN. Relative error below 1e-15.
[[nodiscard]] constexpr double square_root(double value) noexcept {
  if (value != value) return value;
  if (!(value > 0.0)) return 0.0;
  if (value > 1e300) return value;
  double scale = 1.0;
  while (value > 4.0) {
    value *= 0.25;
    scale *= 2.0;
  }
  while (value < 1.0) {
    value *= 4.0;
    scale *= 0.5;
  }
  double root = 1.5;
  for (int i = 0; i < 6; ++i) root = 0.5 * (root + value / root);
  return root * scale;
}

}  // namespace compueye::recon::core
