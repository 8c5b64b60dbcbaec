#include <algorithm>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

/// Longest way that something on a display goes between two pictures.
double step_mm(const Circumstances& c) noexcept {
  double farthest = 0.0;
  if (!(c.scene.display.refresh_hz > 0.0)) return farthest;
  for (const Surface& surface : c.scene.surfaces) {
    if (surface.shines) farthest = std::max(farthest, speed_mm_per_s(surface) / c.scene.display.refresh_hz);
  }
  return farthest;
}

}  // namespace

// What is shown is late by up to a step, half of one in the mean: the level's change is at most the gradient's over the
// step.
const Effect effect::display_refresh{
    .name = "display_refresh",
    .group = EffectGroup::scene,
    .model = "what moves on a display moves in steps of 1 / refresh",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double step = step_mm(c);
      return step > 0.0 ? "a display moves in steps of " + figure(step) + " mm" : "";
    },
    .bound =
        [](const Circumstances& c) {
          return margin * std::min(steepness_lsb_per_mm(c) * step_mm(c), 2.0 * c.preview.rms);
        },
    .cost = [](const Circumstances&) { return EffectCost{}; },
    .apply =
        [](const Circumstances& c, Workings& w) {
          for (Surface& surface : w.scene.surfaces) {
            if (surface.shines) surface.motion.steps_hz = c.scene.display.refresh_hz;
          }
        },
};

}  // namespace compueye::sim
