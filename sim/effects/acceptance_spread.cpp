#include <algorithm>

#include "sim/effects/build_draws.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "acceptance_spread";

/// Of each ommatidium's angle to the drawn one.
std::vector<double> factors(const Circumstances& c) {
  std::vector<double> factors = build_gaussians(c.board.build, own_name, c.board.eye.ommatidia());
  for (double& factor : factors) factor = std::max(1.0 + c.board.build.acceptance_spread * factor, 0.05);
  return factors;
}

// As drawn, by widened_change_lsb.
double bound(const Circumstances& c) {
  std::vector<double> halves = factors(c);
  for (double& half : halves) half = std::min(half * c.board.eye.acceptance_rad / 2.0, widest_half_rad);
  return widened_change_lsb(c, halves);
}

void apply(const Circumstances& c, Workings& w) {
  const std::vector<double> drawn = factors(c);
  for (std::size_t m = 0; m < w.optics.ommatidia.size(); ++m) {
    for (ConeOfLight& cone : w.optics.ommatidia[m].cones) {
      cone.half_angle_rad = std::min(cone.half_angle_rad * drawn[m], widest_half_rad);
    }
  }
}

}  // namespace

const Effect effect::acceptance_spread{
    .name = own_name,
    .group = EffectGroup::optics,
    .model = "acceptance angle (1 + N(0, spread)), a draw an ommatidium",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double spread = c.board.build.acceptance_spread;
      return spread > 0.0 ? "acceptance angles differ by " + figure(100.0 * spread) + " %" : "";
    },
    .bound = bound,
    .cost =
        [](const Circumstances& c) {
          return EffectCost{step_cost(c, 100.0).frame_s, 0.0};
        },
    .apply = apply,
};

}  // namespace compueye::sim
