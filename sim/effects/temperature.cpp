#include <algorithm>
#include <cmath>

#include "sim/effects/dark_charge.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

/// Largest relative change of the gains.
double gain_change(const Circumstances& c) noexcept {
  const hal::DetectorSettings& d = c.board.detector;
  return std::fabs(d.gain_per_c) * std::max(std::fabs(d.temperature_c - 25.0), std::fabs(end_temperature_c(c) - 25.0));
}

double dark_change_lsb(const Circumstances& c) noexcept {
  return std::fabs(dark_charge_lsb(c.board, end_temperature_c(c)) -
                   dark_charge_lsb(c.board, c.board.detector.temperature_c));
}

std::string calls_for(const Circumstances& c) {
  if (gain_change(c) == 0.0 && dark_change_lsb(c) == 0.0) return "";
  return "from " + figure(c.board.detector.temperature_c) + " to " + figure(end_temperature_c(c)) +
         " degrees C gains change by " + figure(100.0 * gain_change(c)) + " %, dark levels by " +
         figure(dark_change_lsb(c)) + " LSB";
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [board = c.board](FrameInWork& frame) noexcept {
    const double celsius = temperature_c(board.detector, frame.t_s);
    const double gain = 1.0 + board.detector.gain_per_c * (celsius - 25.0);
    const double dark = dark_charge_lsb(board, celsius) - dark_charge_lsb(board, board.detector.temperature_c);
    for (double& level : frame.levels_lsb) level = gain * level + dark;
  });
}

}  // namespace

// Both changes grow steadily, so the end or the start has the largest; they add up at most. Over a steady warming the
// rms is 1 / sqrt 3 of the end's.
const Effect effect::temperature{
    .name = "temperature",
    .group = EffectGroup::detector,
    .model = "level (1 + TC (T - 25)) + dark current at T less that at the start; it doubles every 8 K",
    .error = ErrorKind::offset,
    .calls_for = calls_for,
    .bound = [](const Circumstances& c) { return margin * gain_change(c) * c.preview.rms + dark_change_lsb(c); },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = apply,
};

}  // namespace compueye::sim
