#include <algorithm>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

std::string calls_for(const Circumstances& c) {
  if (c.scene.still()) return "";
  return "something moves at up to " + figure(speed_mm_per_s(c)) + " mm/s";
}

// Left out, the scene stands as it does at its start. A level changes by at most its gradient along the way times the
// way (mean value theorem), rms over channels at most the preview's as long as the way is short beside a look. Farther
// on, what comes into a look has nothing to do with what left it: the change is at most that of a look full of the
// brightest there is, about.
double bound(const Circumstances& c) {
  if (c.preview.standstill_change) return looked_bound(*c.preview.standstill_change);
  const double way = speed_mm_per_s(c) * c.scene.seconds_to_judge();
  const double along = margin * steepness_lsb_per_mm(c) * way;
  if (way < look_radius_mm(c) / 2.0) return along;
  const double other = std::max(2.0 * c.preview.rms, brightest(c) * white_lsb(c) / 2.0);
  return std::max(std::min(along, other), 2.0 * c.preview.rms);
}

}  // namespace

const Effect effect::motion{
    .name = "motion",
    .group = EffectGroup::scene,
    .model = "surfaces where they are at the middle of each exposure",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return c.scene.still() ? EffectCost{} : render_cost(c, 1.0); },
    .apply = [](const Circumstances&, Workings& w) { w.render.motion = true; },
};

}  // namespace compueye::sim
