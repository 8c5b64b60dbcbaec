#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim {
namespace {

void apply(const Circumstances& c, Workings& w) {
  const double rms = c.board.sensor.read_noise_lsb;
  if (!(rms > 0.0)) return;
  add_step(w, [rms, seed = w.seed](FrameInWork& frame) noexcept {
    for (std::size_t m = 0; m < frame.levels_lsb.size(); ++m) {
      // Draws::read_noise, not draws_of("read_noise"): recorded samples hang on these draws.
      RandomStream random({seed, Draws::read_noise, frame.frame, static_cast<std::uint32_t>(m)});
      frame.levels_lsb[m] += rms * random.gaussian();
    }
  });
}

}  // namespace

// Bound: the noise's own rms, exactly.
const Effect effect::read_noise{
    .name = "read_noise",
    .group = EffectGroup::electronics,
    .model = "level + N(0, s)",
    .error = ErrorKind::white,
    .noise = true,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double rms = c.board.sensor.read_noise_lsb;
      return rms > 0.0 ? "the converter reads " + figure(rms) + " LSB of noise" : "";
    },
    .bound = [](const Circumstances& c) { return c.board.sensor.read_noise_lsb; },
    .cost = [](const Circumstances& c) { return step_cost(c, 60.0); },
    .apply = apply,
};

}  // namespace compueye::sim
