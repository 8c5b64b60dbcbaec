#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim {
namespace {

class Step final : public FrameStep {
 public:
  Step(std::uint64_t seed, double rms_lsb) : seed_(seed), rms_lsb_(rms_lsb) {}
  void apply(FrameInWork& frame) noexcept override {
    for (std::size_t m = 0; m < frame.levels_lsb.size(); ++m) {
      // Draws::read_noise, not draws_of("read_noise"): recorded samples hang on these draws.
      RandomStream random({seed_, Draws::read_noise, frame.frame, static_cast<std::uint32_t>(m)});
      frame.levels_lsb[m] += rms_lsb_ * random.gaussian();
    }
  }

 private:
  std::uint64_t seed_;
  double rms_lsb_;
};

}  // namespace

// Bound: the noise's own rms, exactly.
const Effect effect::read_noise{
    .name = "read_noise",
    .group = EffectGroup::electronics,
    .model = "level + N(0, s)",
    .error = ErrorKind::white,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double rms = c.board.sensor.read_noise_lsb;
      return rms > 0.0 ? "the converter reads " + figure(rms) + " LSB of noise" : "";
    },
    .bound = [](const Circumstances& c) { return c.board.sensor.read_noise_lsb; },
    .cost = [](const Circumstances& c) { return step_cost(c, 40.0); },
    .apply = [](const Circumstances& c,
                Workings& w) { w.steps.push_back(std::make_unique<Step>(w.seed, c.board.sensor.read_noise_lsb)); },
};

}  // namespace compueye::sim
