#include <cmath>

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
    .bound =
        [](const Circumstances& c) {
          // The converter's bow stretches it by its slope, 4 INL / full scale at most.
          const double slope = 4.0 * std::fabs(c.board.detector.inl_lsb) / std::ldexp(1.0, c.board.sensor.bits);
          return c.board.sensor.dark_level_lsb * (1.0 + slope + 1e-9);
        },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
