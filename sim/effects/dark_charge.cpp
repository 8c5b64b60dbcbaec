#include "sim/effects/dark_charge.hpp"

#include <algorithm>
#include <cmath>

#include "sim/effects/estimates.hpp"

namespace compueye::sim {

double dark_charge_lsb(const EyeToSimulate& board, double celsius) noexcept {
  const hal::DetectorSettings& d = board.detector;
  if (!(d.electrons_per_lsb > 0.0)) return 0.0;
  return d.dark_current_e_per_s * board.integration_s() * std::exp2((celsius - 25.0) / 8.0) / d.electrons_per_lsb;
}

double temperature_c(const hal::DetectorSettings& detector, double t_s) noexcept {
  return std::clamp(detector.temperature_c + detector.warming_c_per_s * t_s, -40.0, 125.0);
}

double largest_level_lsb(const Circumstances& c, double level_lsb) noexcept {
  const hal::DetectorSettings& d = c.board.detector;
  const double light = (1.0 + c.scene.light.flicker_depth) * (1.0 + 4.0 * c.board.build.gain_spread);
  const double level = margin * level_lsb * light + dark_charge_lsb(c.board, d.temperature_c);
  return d.electrons_per_lsb > 0.0 ? level + 5.0 * std::sqrt(level / d.electrons_per_lsb) : level;
}

}  // namespace compueye::sim
