#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

/// Of a shell: growing as the square of its width up to the drawn one, as third-order coma does with the aperture.
double aside_rad(const Circumstances& c, double half_rad) noexcept {
  const double drawn = c.board.eye.acceptance_rad / 2.0;
  return c.board.build.coma * drawn * std::pow(std::min(half_rad / drawn, 1.0), 2);
}

bool looks_aside(const hal::Vec3& axis) noexcept {
  return std::hypot(axis.x, axis.y) > 1e-9;
}

// As if every shell looked aside as far as the outermost does.
double bound(const Circumstances& c) {
  std::vector<double> turns;
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    const bool aside = looks_aside(c.board.eye.axis(m / c.board.eye.columns, m % c.board.eye.columns));
    turns.push_back(aside ? aside_rad(c, c.board.eye.acceptance_rad / 2.0) : 0.0);
  }
  return shifted_change_lsb(c, turns, std::vector<double>(turns.size(), 0.0));
}

void apply(const Circumstances& c, Workings& w) {
  for (OmmatidiumOptics& optics : w.optics.ommatidia) {
    for (ConeOfLight& cone : optics.cones) {
      if (!looks_aside(cone.axis)) continue;
      cone.axis = turned(cone.axis, {cone.axis.x, cone.axis.y, 0.0}, aside_rad(c, cone.half_angle_rad));
    }
  }
}

}  // namespace

const Effect effect::coma{
    .name = "coma",
    .group = EffectGroup::optics,
    .model = "shells look away from the front by coma D/2 (2a/D)^2, a their half angle, at most coma D/2",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double coma = c.board.build.coma;
      return coma > 0.0 ? "outer shells look aside by " + figure(100.0 * coma) + " % of their half angle" : "";
    },
    .bound = bound,
    .cost =
        [](const Circumstances& c) {
          return EffectCost{step_cost(c, 300.0).frame_s, 0.0};
        },
    .apply = apply,
};

}  // namespace compueye::sim
