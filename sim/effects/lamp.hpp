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

/// Of all levels: the lamp's where it lights something, else the display's.
[[nodiscard]] inline double light_drift_per_hour(const Scene& scene) noexcept {
  return lamp_lights(scene) ? scene.light.drift_per_hour : scene.display.drift_per_hour;
}

}  // namespace compueye::sim
