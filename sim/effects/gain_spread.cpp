#include <cmath>

#include "sim/effects/build_draws.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "gain_spread";

std::vector<double> changes(const Circumstances& c) {
  std::vector<double> changes = build_gaussians(c.board.build, own_name, c.board.eye.ommatidia());
  for (double& change : changes) change *= c.board.build.gain_spread;
  return changes;
}

// Every level times its own change, exactly as drawn: only the preview's levels are not exact.
double bound(const Circumstances& c) {
  const std::vector<double> drawn = changes(c);
  double squares = 0.0;
  for (std::size_t m = 0; m < drawn.size(); ++m) squares += std::pow(drawn[m] * c.preview.levels[m], 2);
  return margin * std::sqrt(squares / static_cast<double>(drawn.size()));
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [changes = changes(c)](FrameInWork& frame) noexcept {
    for (std::size_t m = 0; m < frame.levels_lsb.size(); ++m) frame.levels_lsb[m] *= 1.0 + changes[m];
  });
}

}  // namespace

const Effect effect::gain_spread{
    .name = own_name,
    .group = EffectGroup::detector,
    .model = "level (1 + N(0, PRNU)), a draw a channel (EMVA 1288)",
    .error = ErrorKind::per_channel,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double spread = c.board.build.gain_spread;
      return spread > 0.0 ? "gains differ by " + figure(100.0 * spread) + " %" : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
