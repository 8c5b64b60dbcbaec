#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/effects/lamp.hpp"

namespace compueye::sim {
namespace {

constexpr double hour_s = 3600.0;

std::string calls_for(const Circumstances& c) {
  const double drift = c.scene.display.drift_per_hour;
  if (drift == 0.0 || lamp_lights(c.scene)) return "";
  return "the display drifts by " + figure(100.0 * drift) + " % an hour";
}

// As lamp_drift: all levels change by the same share, most at the end.
double bound(const Circumstances& c) {
  const double change = c.scene.display.drift_per_hour * c.scene.seconds_to_judge() / hour_s;
  return margin * std::fabs(change) * c.preview.rms;
}

void apply(const Circumstances& c, Workings& w) {
  if (lamp_lights(c.scene)) return;
  add_step(w, [drift = c.scene.display.drift_per_hour](FrameInWork& frame) noexcept {
    const double light = std::max(1.0 + drift * frame.t_s / hour_s, 0.0);
    for (double& level : frame.levels_lsb) level *= light;
  });
}

}  // namespace

const Effect effect::display_drift{
    .name = "display_drift",
    .group = EffectGroup::scene,
    .model = "level (1 + drift t), where displays alone shine",
    .error = ErrorKind::common_gain,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
