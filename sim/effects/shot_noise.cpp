#include <algorithm>
#include <cmath>

#include "sim/effects/dark_charge.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/random/poisson.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "shot_noise";

std::string calls_for(const Circumstances& c) {
  const double electrons = c.board.detector.electrons_per_lsb;
  const double level = c.preview.largest + largest_dark_charge_lsb(c);
  if (!(electrons > 0.0 && (level > 0.0 || !c.scene.still()))) return "";
  return "the brightest channel has " + figure(level * electrons) + " electrons";
}

// A Poisson number of mean S e has the variance S e, so the level S has the variance S / e; its mean over the channels
// is mean S / e.
double bound(const Circumstances& c) {
  const double dark = largest_dark_charge_lsb(c);
  const double level = margin * std::max(c.preview.mean, 0.0) + dark;
  return std::sqrt(level / c.board.detector.electrons_per_lsb);
}

void apply(const Circumstances& c, Workings& w) {
  const double electrons = c.board.detector.electrons_per_lsb;
  if (!(electrons > 0.0)) return;
  add_step(w, [electrons, seed = w.seed](FrameInWork& frame) noexcept {
    for (std::size_t m = 0; m < frame.levels_lsb.size(); ++m) {
      if (!(frame.levels_lsb[m] > 0.0)) continue;
      RandomStream random({seed, draws_of(own_name), frame.frame, static_cast<std::uint32_t>(m)});
      frame.levels_lsb[m] = poisson(random, frame.levels_lsb[m] * electrons) / electrons;
    }
  });
}

}  // namespace

const Effect effect::shot_noise{
    .name = own_name,
    .group = EffectGroup::detector,
    .model = "Poisson(level e) / e, e electrons per LSB",
    .error = ErrorKind::white,
    .noise = true,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 80.0); },
    .apply = apply,
};

}  // namespace compueye::sim
