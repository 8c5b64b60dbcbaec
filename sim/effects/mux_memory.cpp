#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/effects/levels_before.hpp"

namespace compueye::sim {
namespace {

/// Of a level less that of the channel which its converter read before, over all channels.
double mean_square_step(const Circumstances& c) noexcept {
  const std::vector<double>& levels = c.preview.levels;
  const auto channels = static_cast<int>(levels.size());
  double squares = 0.0;
  for (int m = 0; m < channels; ++m) {
    const auto before = c.board.detector.read_before(m, channels);
    if (before) squares += std::pow(levels[static_cast<std::size_t>(m)] - levels[static_cast<std::size_t>(*before)], 2);
  }
  return squares / channels;
}

// The voltage that the converter reads is v_i = y_i + m (v_(i-1) - y_i), so v - y = sum over k >= 1 of m^k times the
// step between channels i - k + 1 and i - k: rms at most m / (1 - m) that of the steps. First channels of a converter
// have nothing before them. Steps are those of the scene, as bright as light may get, and of what each channel has for
// itself (gains, photons, a hot channel): variances of two channels add up.
double bound(const Circumstances& c) {
  const double memory = c.board.detector.mux_memory();
  const LevelsBefore before = levels_before(effect::mux_memory, c);
  const double step =
      std::sqrt(before.brighter * before.brighter * mean_square_step(c) + 2.0 * before.uneven_lsb * before.uneven_lsb);
  return margin * memory / (1.0 - memory) * step;
}

void apply(const Circumstances& c, Workings& w) {
  const double memory = c.board.detector.mux_memory();
  if (!(memory > 0.0)) return;
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  const int channels = c.board.eye.ommatidia();
  std::vector<std::size_t> before(static_cast<std::size_t>(channels), none);
  for (int m = 0; m < channels; ++m) {
    const auto read = c.board.detector.read_before(m, channels);
    if (read) before[static_cast<std::size_t>(m)] = static_cast<std::size_t>(*read);
  }
  // In ascending order, so that the channel before already is what its converter read; between frames it settles.
  add_step(w, [memory, before = std::move(before)](FrameInWork& frame) noexcept {
    for (std::size_t m = 0; m < before.size(); ++m) {
      if (before[m] == none) continue;
      frame.levels_lsb[m] += memory * (frame.levels_lsb[before[m]] - frame.levels_lsb[m]);
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
