#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

double way_mm(const Circumstances& c) noexcept {
  return speed_mm_per_s(c) * c.board.integration_s();
}

/// Renders so close that less than a quarter of a look is gone between two.
int instants(const Circumstances& c) noexcept {
  return static_cast<int>(std::clamp(std::ceil(4.0 * way_mm(c) / look_radius_mm(c)), 2.0, 16.0));
}

// The mean of a level along a way w about its middle is the level there plus w^2 / 24 times its second derivative along
// it; where the way is long, less than the gradient's mean over w / 4. Bends that are finer than the preview's pixels
// make up to three times that (seen of a turning star).
double bound(const Circumstances& c) {
  const double way = way_mm(c);
  const double curved = way * way / 24.0 * c.preview.laplacian_rms, steep = way / 4.0 * steepness_lsb_per_mm(c);
  return 3.0 * margin * std::min({curved, steep, c.preview.rms});
}

}  // namespace

const Effect effect::motion_blur{
    .name = "motion_blur",
    .group = EffectGroup::timing,
    .model = "mean over instants of the integration time",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      if (c.scene.still()) return "";
      return "something moves by " + figure(way_mm(c)) + " mm while light is gathered";
    },
    .bound = bound,
    .cost =
        [](const Circumstances& c) {
          return c.scene.still() ? EffectCost{} : EffectCost{0.0, render_cost(c, instants(c) - 1.0).frame_s};
        },
    .apply =
        [](const Circumstances& c, Workings& w) {
          if (!c.scene.still()) w.exposure.instants = instants(c);
        },
};

}  // namespace compueye::sim
