#pragma once

#include <vector>

#include "hal/result.hpp"

namespace compueye::sim {

/// One flat-top cone: every ray within `half_angle_rad` of the axis counts `weight`.
struct Shell {
  double half_angle_rad = 0.0;
  double weight = 1.0;
};

/// How strongly an ommatidium takes in light at each angle from its axis, as a sum of flat-top cones. One shell is the
/// flat top of Lee et al. (2016); any profile that falls with the angle is a stack of shells of positive weight whose
/// heights add up to it, so a new profile needs no new integrator.
struct AngularProfile {
  std::vector<Shell> shells;

  [[nodiscard]] static AngularProfile flat_top(double acceptance_rad) { return {{{acceptance_rad / 2.0, 1.0}}}; }

  /// Errors: out_of_range (no shell, a half angle outside 0..60 deg, a weight that is not finite).
  [[nodiscard]] hal::Result<void> validate() const;
};

}  // namespace compueye::sim
