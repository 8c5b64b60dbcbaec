#pragma once

#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// Whether something is lit by the lamp. Where displays shine beside it their light is taken for the lamp's: levels are
/// sums of both.
[[nodiscard]] inline bool lamp_lights(const Scene& scene) noexcept {
  for (const Surface& surface : scene.surfaces) {
    if (!surface.shines) return true;
  }
  return false;
}

}  // namespace compueye::sim
