#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [dark = c.board.sensor.dark_level_lsb](FrameInWork& frame) noexcept {
    for (double& level : frame.levels_lsb) level += dark;
  });
}

}  // namespace

// Bound: what is added, exactly.
const Effect effect::dark_level{
    .name = "dark_level",
    .group = EffectGroup::detector,
    .model = "level + dark level",
    .error = ErrorKind::offset,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double level = c.board.sensor.dark_level_lsb;
      return level > 0.0 ? "codes stand on " + figure(level) + " LSB" : "";
    },
    .bound = [](const Circumstances& c) { return c.board.sensor.dark_level_lsb; },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
