#pragma once

#include <cmath>

#include "hal/vec3.hpp"

namespace compueye::sim {

/// How much a point of a surface counts for one ommatidium: the piece of the object plane that it covers as seen from
/// the apex, times cos^obliquity of the ray's angle. With d from the apex to the point, Z the object plane's z -
/// apex's, n dA the point's vector area away from the eye: Z^2 (n.d) / d_z^3 dA (d_z/|d|)^obliquity, in pixels of the
/// object plane.
struct RayWeight {
  double scale = 1.0;  ///< Z^2 / area of an object pixel
  double obliquity = 0.0;
  int halves = -1;  ///< obliquity in halves where it is a few of them: roots are faster than pow

  RayWeight(double scale_, double obliquity_) noexcept : scale(scale_), obliquity(obliquity_) {
    if (2.0 * obliquity == std::floor(2.0 * obliquity) && obliquity >= 0.0 && obliquity <= 8.0) {
      halves = static_cast<int>(2.0 * obliquity);
    }
  }

  /// Nothing where the surface is turned away.
  [[nodiscard]] double operator()(const hal::Vec3& d, double facing) const noexcept {
    return facing > 0.0 ? either_way(d, facing) : 0.0;
  }
  /// Negative there: smooth across the edge of what is seen, for those who know where that is.
  [[nodiscard]] double either_way(const hal::Vec3& d, double facing) const noexcept {
    if (!(d.z > 0.0)) return 0.0;
    const double inverse = 1.0 / d.z;
    const double weight = scale * facing * inverse * inverse * inverse;
    if (obliquity == 0.0) return weight;
    const double cosine2 = d.z * d.z / dot(d, d);
    if (halves < 0) return weight * std::pow(cosine2, 0.5 * obliquity);
    const double root = std::sqrt(std::sqrt(cosine2));
    double power = 1.0;
    for (int k = 0; k < halves; ++k) power *= root;
    return weight * power;
  }
};

}  // namespace compueye::sim
