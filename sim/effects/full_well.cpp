#include <algorithm>
#include <cmath>

#include "sim/effects/dark_charge.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

double capacity_lsb(const hal::DetectorSettings& d) noexcept {
  return d.electrons_per_lsb > 0.0 && d.full_well_e > 0.0 ? d.full_well_e / d.electrons_per_lsb : HUGE_VAL;
}

/// What may stand before channel `m`: where things move, anything.
double level_lsb(const Circumstances& c, std::size_t m) noexcept {
  return c.scene.still() ? c.preview.levels[m] : std::max(c.preview.largest, brightest(c) * white_lsb(c));
}

std::string calls_for(const Circumstances& c) {
  const double capacity = capacity_lsb(c.board.detector);
  const double electrons = c.board.detector.electrons_per_lsb;
  double most = 0.0;
  for (std::size_t m = 0; m < c.preview.levels.size(); ++m) most = std::max(most, level_lsb(c, m));
  const double largest = largest_level_lsb(c, most);
  if (!(largest > capacity)) return "";
  return "up to " + figure(largest * electrons) + " electrons in a well of " + figure(capacity * electrons);
}

// What is cut off each channel's level, were light, gains, dark current and quanta all at their largest.
double bound(const Circumstances& c) {
  const double capacity = capacity_lsb(c.board.detector);
  double squares = 0.0;
  for (std::size_t m = 0; m < c.preview.levels.size(); ++m) {
    squares += std::pow(std::max(largest_level_lsb(c, level_lsb(c, m)) - capacity, 0.0), 2);
  }
  return std::sqrt(squares / static_cast<double>(c.preview.levels.size()));
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [capacity = capacity_lsb(c.board.detector)](FrameInWork& frame) noexcept {
    for (double& level : frame.levels_lsb) level = std::min(level, capacity);
  });
}

}  // namespace

const Effect effect::full_well{
    .name = "full_well",
    .group = EffectGroup::detector,
    .model = "min(level, full well / e)",
    .error = ErrorKind::per_channel,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
