#include "sim/effects/dark_charge.hpp"

#include <algorithm>
#include <cmath>

#include "sim/effects/drift.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/lamp.hpp"

namespace compueye::sim {

double dark_charge_lsb(const EyeToSimulate& board, double celsius) noexcept {
  const hal::DetectorSettings& d = board.detector;
  if (!(d.electrons_per_lsb > 0.0)) return 0.0;
  return d.dark_current_e_per_s * board.integration_s() * std::exp2((celsius - 25.0) / 8.0) / d.electrons_per_lsb;
}

double temperature_c(const hal::DetectorSettings& detector, double t_s) noexcept {
  return std::clamp(detector.temperature_c + detector.warming_c_per_s * t_s, -40.0, 125.0);
}

double end_temperature_c(const Circumstances& c) noexcept {
  return temperature_c(c.board.detector, c.scene.seconds_of_drift());
}

double largest_dark_charge_lsb(const Circumstances& c) noexcept {
  return dark_charge_lsb(c.board, std::max(c.board.detector.temperature_c, end_temperature_c(c)));
}

double largest_level_lsb(const Circumstances& c, double level_lsb) noexcept {
  const hal::DetectorSettings& d = c.board.detector;
  const double light = (1.0 + c.scene.light.flicker_depth) * (1.0 + 4.0 * c.board.build.gain_spread);
  const double drift = largest_drift(c, light_drift_per_hour(c.scene));
  const double from = d.gain_per_c * (d.temperature_c - 25.0), to = d.gain_per_c * (end_temperature_c(c) - 25.0);
  const double gain = 1.0 + std::max({0.0, from, to});
  const double level = margin * level_lsb * light * drift * gain + largest_dark_charge_lsb(c);
  return d.electrons_per_lsb > 0.0 ? level + 5.0 * std::sqrt(level / d.electrons_per_lsb) : level;
}

}  // namespace compueye::sim
