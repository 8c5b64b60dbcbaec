#include <cmath>
#include <numbers>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/effects/lamp.hpp"

namespace compueye::sim {
namespace {

/// What is left of the flicker after it is averaged over the integration time T: depth sinc(2 mains T); none where T is
/// a whole number of half periods.
double depth_left(const Circumstances& c) noexcept {
  const Light& light = c.scene.light;
  const double half_turns = std::numbers::pi * 2.0 * light.mains_hz * c.board.integration_s();
  if (!(light.mains_hz > 0.0 && light.flicker_depth > 0.0) || !lamp_lights(c.scene)) return 0.0;
  const double left = light.flicker_depth * std::sin(half_turns) / half_turns;
  return std::fabs(left) < 1e-12 ? 0.0 : left;
}

void apply(const Circumstances& c, Workings& w) {
  const double depth = depth_left(c);
  if (depth == 0.0) return;
  const double turn_per_s = 2.0 * std::numbers::pi * 2.0 * c.scene.light.mains_hz,
               middle_s = c.board.integration_s() / 2.0;
  add_step(w, [depth, turn_per_s, middle_s](FrameInWork& frame) noexcept {
    const double light = 1.0 + depth * std::sin(turn_per_s * (frame.t_s + middle_s));
    for (double& level : frame.levels_lsb) level *= light;
  });
}

}  // namespace

// All levels change by the same share, at most by what is left; frames that keep step with the mains may all have that
// much, others 1 / sqrt 2 of it rms.
const Effect effect::mains_flicker{
    .name = "mains_flicker",
    .group = EffectGroup::scene,
    .model = "level (1 + depth sinc(2 f T) sin(2 pi 2 f t)), t in the middle of the integration time T",
    .error = ErrorKind::common_gain,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double left = depth_left(c);
      if (left == 0.0) return "";
      return "light of the mains at " + figure(c.scene.light.mains_hz) + " Hz flickers by " +
             figure(100.0 * std::fabs(left)) + " % after integration";
    },
    .bound = [](const Circumstances& c) { return margin * std::fabs(depth_left(c)) * c.preview.rms; },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
