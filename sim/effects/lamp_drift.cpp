#include "sim/effects/drift.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/lamp.hpp"

namespace compueye::sim {
namespace {

double drift_of(const Circumstances& c) noexcept {
  return lamp_lights(c.scene) ? c.scene.light.drift_per_hour : 0.0;
}

}  // namespace

const Effect effect::lamp_drift{
    .name = "lamp_drift",
    .group = EffectGroup::scene,
    .model = "level (1 + drift t), where nothing shines by itself beside the lamp",
    .error = ErrorKind::common_gain,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double drift = drift_of(c);
      return drift != 0.0 ? "the lamp drifts by " + figure(100.0 * drift) + " % an hour" : "";
    },
    .bound = [](const Circumstances& c) { return drift_bound(c, drift_of(c)); },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = [](const Circumstances& c, Workings& w) { add_drift(w, drift_of(c)); },
};

}  // namespace compueye::sim
