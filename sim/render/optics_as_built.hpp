#pragma once

#include <vector>

#include "hal/eye_geometry.hpp"

namespace compueye::sim {

/// One flat-top cone of light: every ray within `half_angle_rad` (0 .. 60 deg) of `axis` counts `weight`.
struct ConeOfLight {
  hal::Vec3 axis;  ///< unit vector
  double half_angle_rad = 0.0;
  double weight = 1.0;
};

/// An ommatidium: a stack of cones. Any profile that falls with the angle is one, of positive weights; a lopsided one
/// (coma) has cones of different axes; dust on half of a lens is a cone of negative weight.
struct OmmatidiumOptics {
  hal::Vec3 apex_mm;  ///< in the eye's frame: hal::EyeGeometry
  std::vector<ConeOfLight> cones;
};

struct OpticsAsBuilt {
  std::vector<OmmatidiumOptics> ommatidia;  ///< M, m = i * columns + k
  /// Light along a ray at angle t from z counts cos^obliquity t.
  double obliquity = 0.0;

  /// Every ommatidium as drawn: one cone of the acceptance angle.
  [[nodiscard]] static OpticsAsBuilt drawn(const hal::EyeGeometry& eye);
};

}  // namespace compueye::sim
