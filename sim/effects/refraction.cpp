#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"
#include "sim/effects/widened_cones.hpp"

namespace compueye::sim {
namespace {

/// What a half angle h that was drawn as n times that before the photodiode is by Snell: sin outside = n sin inside.
double refracted(const Circumstances& c, double half_rad) {
  const double index = c.board.build.refractive_index;
  return std::min(std::asin(std::min(index * std::sin(half_rad / index), 1.0)), widest_half_rad);
}

std::string calls_for(const Circumstances& c) {
  const double wider = widened_share(c, refracted);
  if (!(wider > 0.0)) return "";
  return "an index of " + figure(c.board.build.refractive_index) + " widens the acceptance angle by " +
         figure(100.0 * wider) + " %";
}

}  // namespace

const Effect effect::refraction{
    .name = "refraction",
    .group = EffectGroup::optics,
    .model = "the drawn angle is n dphi, dphi inside; by Snell it is 2 asin(n sin(dphi / 2))",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = [](const Circumstances& c) { return widened_bound(c, refracted); },
    .cost =
        [](const Circumstances& c) {
          return EffectCost{step_cost(c, 100.0).frame_s, 0.0};
        },
    .apply = [](const Circumstances& c, Workings& w) { widen_cones(c, w, refracted); },
};

}  // namespace compueye::sim
