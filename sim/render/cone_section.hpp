#pragma once

#include "hal/eye_geometry.hpp"

namespace compueye::sim {

/// lo > hi: nothing.
struct Interval {
  double lo = 0.0;
  double hi = -1.0;
  [[nodiscard]] bool empty() const noexcept { return !(lo <= hi); }
};

/// The part of a plane perpendicular to z that one circular cone sees. A ray (u, v, Z) from the apex is inside when
/// u dx + v dy + Z dz >= cos(h) |(u, v, Z)|. For h <= 60 deg that is a convex region in front of the apex (the other
/// nappe never enters), so every line across it holds one interval, ended by an ellipse, a parabola or one branch of a
/// hyperbola alike.
class ConeSection {
 public:
  /// `axis` is a unit vector; `depth_mm` > 0 is the distance Z along z from the apex to the plane.
  ConeSection(const hal::Vec3& axis, double half_angle_rad, double depth_mm) noexcept;

  /// Extent of the region relative to the apex; an end may be infinite.
  [[nodiscard]] Interval u_range() const noexcept { return range(axis_.x, axis_.y); }
  [[nodiscard]] Interval v_range() const noexcept { return range(axis_.y, axis_.x); }

  /// The u that are inside at height v, relative to the apex; an end may be infinite.
  [[nodiscard]] Interval chord(double v) const noexcept;

 private:
  [[nodiscard]] Interval range(double along, double across) const noexcept;

  hal::Vec3 axis_;
  double sine_, cosine_, depth_;
  double a_, inverse_a_;  // a = cos^2 h - dx^2: > 0 bounded chords, <= 0 half lines
};

}  // namespace compueye::sim
