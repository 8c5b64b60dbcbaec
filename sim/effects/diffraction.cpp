#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"
#include "sim/effects/widened_cones.hpp"

namespace compueye::sim {
namespace {

constexpr double wavelength_mm = 550e-6;

/// The lens's own blur, lambda / D, added to the angle in squares.
double diffracted(const Circumstances& c, double half_rad) {
  const double lens_mm = c.board.build.lens_diameter_mm;
  if (!(lens_mm > 0.0)) return half_rad;
  return std::min(std::hypot(half_rad, wavelength_mm / lens_mm / 2.0), widest_half_rad);
}

std::string calls_for(const Circumstances& c) {
  const double wider = widened_share(c, diffracted);
  if (!(wider > 0.0)) return "";
  return "a lens of " + figure(c.board.build.lens_diameter_mm) + " mm widens the acceptance angle by " +
         figure(100.0 * wider) + " %";
}

}  // namespace

const Effect effect::diffraction{
    .name = "diffraction",
    .group = EffectGroup::optics,
    .model = "dphi' = sqrt(dphi^2 + (lambda / D)^2), lambda = 550 nm, D the lens's diameter",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = [](const Circumstances& c) { return widened_bound(c, diffracted); },
    .cost =
        [](const Circumstances& c) {
          return EffectCost{step_cost(c, 100.0).frame_s, 0.0};
        },
    .apply = [](const Circumstances& c, Workings& w) { widen_cones(c, w, diffracted); },
};

}  // namespace compueye::sim
