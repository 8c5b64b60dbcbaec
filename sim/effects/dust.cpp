#include <cmath>
#include <numbers>

#include "sim/effects/build_draws.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "dust";

/// Whether dust lies on it, and on which side.
struct Speck {
  bool there = false;
  double direction_rad = 0.0;
};

Speck speck(const hal::BuildSettings& build, std::size_t m) noexcept {
  RandomStream random = build_draws(build, own_name, static_cast<int>(m));
  const bool there = random.uniform() < build.dust_share;
  return {there, random.uniform(0.0, 2.0 * std::numbers::pi)};
}

// A dusty channel loses at most dust_loss of its level, were all of its light on the dusty half.
double bound(const Circumstances& c) {
  double squares = 0.0;
  for (std::size_t m = 0; m < c.preview.levels.size(); ++m) {
    if (speck(c.board.build, m).there) squares += std::pow(c.preview.levels[m], 2);
  }
  return margin * c.board.build.dust_loss * std::sqrt(squares / static_cast<double>(c.preview.levels.size()));
}

/// A cone of half the area within `cone`, touching its edge on the dusty side.
ConeOfLight shade(const ConeOfLight& cone, double direction_rad, double loss) noexcept {
  const Across directions = across(cone.axis);
  const double x = std::cos(direction_rad), y = std::sin(direction_rad);
  const hal::Vec3 side{x * directions.first.x + y * directions.second.x,
                       x * directions.first.y + y * directions.second.y,
                       x * directions.first.z + y * directions.second.z};
  const double half = cone.half_angle_rad / std::numbers::sqrt2;
  return {turned(cone.axis, side, cone.half_angle_rad - half), half, -loss * cone.weight};
}

void apply(const Circumstances& c, Workings& w) {
  for (std::size_t m = 0; m < w.optics.ommatidia.size(); ++m) {
    const Speck at = speck(c.board.build, m);
    if (!at.there) continue;
    std::vector<ConeOfLight>& cones = w.optics.ommatidia[m].cones;
    for (std::size_t k = 0, clean = cones.size(); k < clean; ++k) {
      cones.push_back(shade(cones[k], at.direction_rad, c.board.build.dust_loss));
    }
  }
}

}  // namespace

const Effect effect::dust{
    .name = own_name,
    .group = EffectGroup::optics,
    .model = "half of the view of some ommatidia, a cone of half the area at its edge, dimmer by dust_loss",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const hal::BuildSettings& build = c.board.build;
      if (!(build.dust_share > 0.0 && build.dust_loss > 0.0)) return "";
      return "dust on " + figure(100.0 * build.dust_share) + " % of ommatidia takes " +
             figure(100.0 * build.dust_loss) + " % of half their light";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return render_once_cost(c, c.board.build.dust_share); },
    .apply = apply,
};

}  // namespace compueye::sim
