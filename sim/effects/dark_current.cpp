#include <cmath>

#include "sim/effects/dark_charge.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

double dark_lsb(const Circumstances& c) noexcept {
  return dark_charge_lsb(c.board, c.board.detector.temperature_c);
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [dark = dark_lsb(c)](FrameInWork& frame) noexcept {
    for (double& level : frame.levels_lsb) level += dark;
  });
}

}  // namespace

// Bound: the mean charge, exactly, and its shot noise, which the effect of that name draws from what it finds.
const Effect effect::dark_current{
    .name = "dark_current",
    .group = EffectGroup::detector,
    .model = "level + I t / (e per LSB), I at the start's temperature; its quanta are shot_noise's",
    .error = ErrorKind::offset,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double dark = dark_lsb(c);
      return dark > 0.0 ? figure(dark * c.board.detector.electrons_per_lsb) + " electrons of dark current a frame" : "";
    },
    .bound =
        [](const Circumstances& c) {
          const double dark = dark_lsb(c);
          return std::sqrt(dark * dark + dark / c.board.detector.electrons_per_lsb);
        },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
