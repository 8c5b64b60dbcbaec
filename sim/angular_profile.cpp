#include "sim/angular_profile.hpp"

#include <cmath>
#include <numbers>
#include <string>

namespace compueye::sim {

hal::Result<void> AngularProfile::validate() const {
  constexpr double widest = std::numbers::pi / 3.0 * (1.0 + 1e-12);
  if (shells.empty()) {
    return hal::fail(hal::ErrorCode::out_of_range, "angular profile", "has no shell, expected at least one cone");
  }
  for (const Shell& shell : shells) {
    if (!(shell.half_angle_rad > 0.0 && shell.half_angle_rad <= widest)) {
      return hal::fail(hal::ErrorCode::out_of_range, "angular profile",
                       "half angle is " + std::to_string(shell.half_angle_rad * 180.0 / std::numbers::pi) +
                           " deg, expected more than 0 and at most 60");
    }
    if (!std::isfinite(shell.weight)) {
      return hal::fail(hal::ErrorCode::out_of_range, "angular profile",
                       "weight is " + std::to_string(shell.weight) + ", expected a finite number");
    }
  }
  return {};
}

}  // namespace compueye::sim
