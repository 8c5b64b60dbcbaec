#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

double bow(double inl_lsb, double full_lsb, double level) noexcept {
  const double u = std::clamp(level / full_lsb, 0.0, 1.0);
  return 4.0 * inl_lsb * u * (1.0 - u);
}

double full_lsb(const Circumstances& c) noexcept {
  return std::ldexp(1.0, c.board.sensor.bits);
}

// The bow at each channel's level; it is flattest where it is largest, so the preview's few per cent of level are no
// more than that of the bow.
double bound(const Circumstances& c) {
  double squares = 0.0;
  for (const double level : c.preview.levels) {
    squares += std::pow(bow(c.board.detector.inl_lsb, full_lsb(c), level + c.board.sensor.dark_level_lsb), 2);
  }
  return margin * std::sqrt(squares / static_cast<double>(c.preview.levels.size()));
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [inl = c.board.detector.inl_lsb, full = full_lsb(c)](FrameInWork& frame) noexcept {
    for (double& level : frame.levels_lsb) level += bow(inl, full, level);
  });
}

}  // namespace

const Effect effect::nonlinearity{
    .name = "nonlinearity",
    .group = EffectGroup::electronics,
    .model = "level + 4 INL u (1 - u), u the level's share of full scale",
    .error = ErrorKind::per_channel,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double inl = c.board.detector.inl_lsb;
      return inl != 0.0 ? "the converter bows by " + figure(inl) + " LSB" : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 1.0); },
    .apply = apply,
};

}  // namespace compueye::sim
