#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

// The voltage that the converter reads is v_i = y_i + m (v_(i-1) - y_i), so v - y = sum over k >= 1 of m^k times the
// step between channels i - k + 1 and i - k: rms at most m / (1 - m) that of the steps. First channels of a converter
// have nothing before them, which the bound counts as if they had. Steps are of the scene and of the photons, whose
// noise differs from channel to channel.
double bound(const Circumstances& c) {
  const double memory = c.board.detector.mux_memory(), electrons = c.board.detector.electrons_per_lsb;
  const double shot_variance = electrons > 0.0 ? c.preview.mean / electrons : 0.0;
  const double step = std::sqrt(c.preview.previous_rms * c.preview.previous_rms + 2.0 * shot_variance);
  return margin * memory / (1.0 - memory) * step;
}

void apply(const Circumstances& c, Workings& w) {
  const double memory = c.board.detector.mux_memory();
  const auto channels = static_cast<std::size_t>(c.board.detector.mux_channels);
  if (!(memory > 0.0) || channels < 2) return;
  add_step(w, [memory, channels](FrameInWork& frame) noexcept {
    for (std::size_t m = 1; m < frame.levels_lsb.size(); ++m) {
      if (m % channels == 0) continue;  // between frames a converter settles
      frame.levels_lsb[m] += memory * (frame.levels_lsb[m - 1] - frame.levels_lsb[m]);
    }
  });
}

}  // namespace

const Effect effect::mux_memory{
    .name = "mux_memory",
    .group = EffectGroup::electronics,
    .model = "v_i = y_i + m (v_(i-1) - y_i), m = exp(-slot / RC), along each converter's channels",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double memory = c.board.detector.mux_memory();
      return memory > 0.0 ? figure(100.0 * memory) + " % of the channel before is left when one is read" : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 4.0); },
    .apply = apply,
};

}  // namespace compueye::sim
