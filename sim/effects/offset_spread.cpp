#include <cmath>

#include "sim/effects/build_draws.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "offset_spread";

std::vector<double> offsets(const Circumstances& c) {
  std::vector<double> offsets = build_gaussians(c.board.build, own_name, c.board.eye.ommatidia());
  for (double& offset : offsets) offset *= c.board.build.offset_spread_lsb;
  return offsets;
}

// What is added, exactly as drawn.
double bound(const Circumstances& c) {
  const std::vector<double> drawn = offsets(c);
  double squares = 0.0;
  for (const double offset : drawn) squares += offset * offset;
  return std::sqrt(squares / static_cast<double>(drawn.size()));
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [offsets = offsets(c)](FrameInWork& frame) noexcept {
    for (std::size_t m = 0; m < frame.levels_lsb.size(); ++m) frame.levels_lsb[m] += offsets[m];
  });
}

}  // namespace

const Effect effect::offset_spread{
    .name = own_name,
    .group = EffectGroup::detector,
    .model = "level + N(0, DSNU), a draw a channel (EMVA 1288)",
    .error = ErrorKind::white,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double spread = c.board.build.offset_spread_lsb;
      return spread > 0.0 ? "dark levels differ by " + figure(spread) + " LSB" : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
