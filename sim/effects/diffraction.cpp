#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

constexpr double wavelength_mm = 550e-6;

/// The lens's own blur, lambda / D, added to the angle in squares.
double diffracted(double half_rad, double lens_mm) noexcept {
  if (!(lens_mm > 0.0)) return half_rad;
  return std::min(std::hypot(half_rad, wavelength_mm / lens_mm / 2.0), widest_half_rad);
}

std::string calls_for(const Circumstances& c) {
  const double half = c.board.eye.acceptance_rad / 2.0, lens = c.board.build.lens_diameter_mm;
  const double wider = diffracted(half, lens) / half - 1.0;
  if (!(wider > 0.0)) return "";
  return "a lens of " + figure(lens) + " mm widens the acceptance angle by " + figure(100.0 * wider) + " %";
}

// By widened_change_lsb, all alike.
double bound(const Circumstances& c) {
  const double half = diffracted(c.board.eye.acceptance_rad / 2.0, c.board.build.lens_diameter_mm);
  return widened_change_lsb(c, std::vector<double>(c.preview.levels.size(), half));
}

void apply(const Circumstances& c, Workings& w) {
  for (OmmatidiumOptics& optics : w.optics.ommatidia) {
    for (ConeOfLight& cone : optics.cones) {
      cone.half_angle_rad = diffracted(cone.half_angle_rad, c.board.build.lens_diameter_mm);
    }
  }
}

}  // namespace

const Effect effect::diffraction{
    .name = "diffraction",
    .group = EffectGroup::optics,
    .model = "dphi' = sqrt(dphi^2 + (lambda / D)^2), lambda = 550 nm, D the lens's diameter",
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
