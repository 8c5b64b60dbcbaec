#pragma once

#include "sim/effects/circumstances.hpp"

namespace compueye::sim {

/// How much each band of a surface's picture counts: the detector's response times the light's spectrum (a display's
/// own is white), of sum 1; nothing where they have nothing in common.
[[nodiscard]] BandWeights band_weights(const EyeToSimulate& board, const Scene& scene, const Surface& surface) noexcept;

}  // namespace compueye::sim
