#pragma once

#include <vector>

#include "hal/build_settings.hpp"

namespace compueye::sim {

/// A cone of a stack, relative to the half angle at which the profile is at a half.
struct ProfileShell {
  double ratio = 1.0;  ///< of half angles, > 0
  double weight = 1.0;
};

/// The profile as a stack of flat cones, out to `widest_ratio`: what they deliver of edges and smooth pictures is the
/// profile's integral to 0.2 % of white. A flat top is one cone.
[[nodiscard]] std::vector<ProfileShell> profile_stack(hal::ProfileKind kind, double edge_order, double widest_ratio);

/// Of an even white field, relative to a flat top.
struct ProfileMoments {
  double light = 1.0;   ///< what it delivers
  double square = 0.5;  ///< mean square of the angle, relative to (D/2)^2
  double apart = 0.0;  ///< light that comes from elsewhere or is not there: integral of the difference's absolute value
};
[[nodiscard]] ProfileMoments moments(std::vector<ProfileShell> stack) noexcept;

}  // namespace compueye::sim
