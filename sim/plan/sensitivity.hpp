#pragma once

#include <array>
#include <optional>

#include "sim/effects/effect.hpp"

namespace compueye::sim {

/// How much a reconstruction of this eye bears, measured elsewhere (recon/sensitivity.hpp) and handed over as figures:
/// NMSE = kappa (rms error of the samples / rms of the samples)^2, by kind of error.
struct Sensitivity {
  std::array<double, error_kinds> kappa{};  ///< in the order of ErrorKind; > 0
  /// False: nobody measured it, and the figures are those of the paper's small eye.
  bool measured = false;

  [[nodiscard]] double of(ErrorKind kind) const noexcept { return kappa[static_cast<std::size_t>(kind)]; }

  /// Of 8x8 ommatidia of 8 degrees over 16x16 pixels: the largest figure of each kind's range, which leaves out least.
  [[nodiscard]] static Sensitivity of_small_eye() noexcept;
};

}  // namespace compueye::sim
