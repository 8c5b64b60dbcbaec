#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/effects/lamp.hpp"

namespace compueye::sim {
namespace {

constexpr double hour_s = 3600.0;

void apply(const Circumstances& c, Workings& w) {
  if (!lamp_lights(c.scene)) return;
  add_step(w, [drift = c.scene.light.drift_per_hour](FrameInWork& frame) noexcept {
    const double light = std::max(1.0 + drift * frame.t_s / hour_s, 0.0);
    for (double& level : frame.levels_lsb) level *= light;
  });
}

}  // namespace

// All levels change by the same share, most at the end; over the time its rms is 1 / sqrt 3 of that.
const Effect effect::lamp_drift{
    .name = "lamp_drift",
    .group = EffectGroup::scene,
    .model = "level (1 + drift t), where nothing shines by itself beside the lamp",
    .error = ErrorKind::common_gain,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double drift = c.scene.light.drift_per_hour;
      return drift != 0.0 && lamp_lights(c.scene) ? "the lamp drifts by " + figure(100.0 * drift) + " % an hour" : "";
    },
    .bound =
        [](const Circumstances& c) {
          const double change = c.scene.light.drift_per_hour * c.scene.seconds_to_judge() / hour_s;
          return margin * std::fabs(change) * c.preview.rms;
        },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
