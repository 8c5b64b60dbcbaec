#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

/// What a half angle h that was drawn as n times that before the photodiode is by Snell: sin outside = n sin inside.
double refracted(double half_rad, double index) noexcept {
  return std::min(std::asin(std::min(index * std::sin(half_rad / index), 1.0)), widest_half_rad);
}

double wider_by(const Circumstances& c) noexcept {
  const double half = c.board.eye.acceptance_rad / 2.0;
  return refracted(half, c.board.build.refractive_index) / half - 1.0;
}

std::string calls_for(const Circumstances& c) {
  const double wider = wider_by(c);
  if (!(wider > 0.0)) return "";
  return "an index of " + figure(c.board.build.refractive_index) + " widens the acceptance angle by " +
         figure(100.0 * wider) + " %";
}

// By widened_change_lsb, all alike.
double bound(const Circumstances& c) {
  const double half = refracted(c.board.eye.acceptance_rad / 2.0, c.board.build.refractive_index);
  return widened_change_lsb(c, std::vector<double>(c.preview.levels.size(), half));
}

void apply(const Circumstances& c, Workings& w) {
  for (OmmatidiumOptics& optics : w.optics.ommatidia) {
    for (ConeOfLight& cone : optics.cones) {
      cone.half_angle_rad = refracted(cone.half_angle_rad, c.board.build.refractive_index);
    }
  }
}

}  // namespace

const Effect effect::refraction{
    .name = "refraction",
    .group = EffectGroup::optics,
    .model = "the drawn angle is n dphi, dphi inside; by Snell it is 2 asin(n sin(dphi / 2))",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost =
        [](const Circumstances& c) {
          return EffectCost{step_cost(c, 100.0).frame_s, 0.0};
        },
    .apply = apply,
};

}  // namespace compueye::sim
