#include <array>
#include <cmath>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "flicker_noise";
constexpr int octaves = 16;

// Normal numbers of variance s^2, held for 2^k frames, k = 0 .. 15, each channel's octaves at their own times: the
// power of each octave of frequencies is the same, so its density falls as 1/f (from 1/2 to 2^-16 of the frame rate).
// About its own mean over N = 1000 frames, numbers held for L frames vary by s^2 (1 - L/N + L^2 / 3N^2) when L <= N
// (the mean of N frames averages N/L of them) and by s^2 N / 3L beyond (a step falls among them with probability N/L
// and splits them evenly at random): 9.734 s^2 in all.
constexpr double variance_over_1000_frames = 9.734;

class Step final : public FrameStep {
 public:
  Step(std::uint64_t seed, double rms_lsb, int channels)
      : seed_(seed),
        octave_rms_(rms_lsb / std::sqrt(variance_over_1000_frames)),
        channels_(static_cast<std::size_t>(channels)) {}

  void apply(FrameInWork& frame) noexcept override {
    for (std::size_t m = 0; m < channels_.size(); ++m) {
      double sum = 0.0;
      for (unsigned k = 0; k < octaves; ++k) sum += held(m, k, frame.frame);
      frame.levels_lsb[m] += octave_rms_ * sum;
    }
  }

 private:
  struct Held {
    std::uint64_t turn = ~std::uint64_t{0};
    double value = 0.0;
  };

  double held(std::size_t m, unsigned k, std::uint64_t frame) noexcept {
    const std::uint64_t phase = m * 0x9E3779B97F4A7C15U >> (64U - octaves);
    const std::uint64_t turn = (frame + phase) >> k;
    Held& held = channels_[m][k];
    if (held.turn != turn) {
      // Octave and turn share the key's frame: turns of octave k stay below 2^56.
      RandomStream random({seed_, draws_of(own_name), (std::uint64_t{k} << 56U) | turn, static_cast<std::uint32_t>(m)});
      held = {turn, random.gaussian()};
    }
    return held.value;
  }

  std::uint64_t seed_;
  double octave_rms_;
  std::vector<std::array<Held, octaves>> channels_;  // what was drawn last: most octaves hold for long
};

}  // namespace

// Bound: the rms over all time, sqrt 16 octaves.
const Effect effect::flicker_noise{
    .name = own_name,
    .group = EffectGroup::electronics,
    .model = "sum of 16 normal numbers held for 1, 2, 4 .. frames: 1/f over 1/2 .. 2^-16 of the frame rate",
    .error = ErrorKind::white,
    .noise = true,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double rms = c.board.detector.flicker_noise_lsb;
      return rms > 0.0 ? "1/f noise of " + figure(rms) + " LSB in 1000 frames" : "";
    },
    .bound =
        [](const Circumstances& c) {
          return margin * c.board.detector.flicker_noise_lsb * std::sqrt(octaves / variance_over_1000_frames);
        },
    .cost = [](const Circumstances& c) { return step_cost(c, 150.0); },
    .apply =
        [](const Circumstances& c, Workings& w) {
          w.steps.push_back(
              std::make_unique<Step>(w.seed, c.board.detector.flicker_noise_lsb, c.board.eye.ommatidia()));
        },
};

}  // namespace compueye::sim
