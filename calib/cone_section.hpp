#pragma once

#include "hal/eye_geometry.hpp"

namespace compueye::calib {

/// A closed interval; infinite ends are allowed, lo > hi is empty.
struct Interval {
  double lo = 1.0, hi = 0.0;
  [[nodiscard]] bool empty() const noexcept { return !(lo <= hi); }
};

enum class SectionKind { empty, ellipse, parabola, hyperbola };

/// What one ommatidium sees of the object plane: the section of its cone, always a convex region. Only the nappe in
/// front of the apex counts, so a hyperbola is one branch and a cone that looks away sees nothing.
///
/// Written as the vertex equation of a conic, about the point where the steepest ray of the cone meets the plane:
///
///     2 p (u . s) + (e . s)^2 - |s|^2 >= 0,   p = h tan(half angle),  e = u sin(tilt) / cos(half angle)
///
/// with s the position from that vertex, u the direction in which the axis leans, h the height of the apex over the
/// plane and tilt the angle between the axis and the plane's normal. One form serves all kinds: it has no centre to
/// run off to infinity at the parabola, and no large terms to cancel when the cone is narrower than a pixel.
///
/// All coordinates below are in mm from vertex(), along the x and y of the eye frame.
class ConeSection {
 public:
  /// Unit `axis`; 0 < `half_angle_rad` < pi/2. The plane is z = `plane_z_mm`. Empty when the apex is not in front of
  /// the plane, when the cone looks away, or when anything is NaN.
  ConeSection(const hal::Vec3& apex, const hal::Vec3& axis, double half_angle_rad, double plane_z_mm) noexcept;

  [[nodiscard]] SectionKind kind() const noexcept { return kind_; }
  [[nodiscard]] bool empty() const noexcept { return kind_ == SectionKind::empty; }
  [[nodiscard]] double vertex_x_mm() const noexcept { return vertex_x_; }
  [[nodiscard]] double vertex_y_mm() const noexcept { return vertex_y_; }
  [[nodiscard]] double eccentricity() const noexcept { return e_; }
  [[nodiscard]] double semi_latus_rectum_mm() const noexcept { return p_; }
  /// pi a b of an ellipse, infinity for the other kinds, 0 when empty.
  [[nodiscard]] double area_mm2() const noexcept;

  [[nodiscard]] Interval x_extent() const noexcept { return x_extent_; }
  [[nodiscard]] Interval y_extent() const noexcept { return y_extent_; }
  /// The y of the section on the vertical line through x, and the x on the horizontal line through y.
  [[nodiscard]] Interval chord_at_x(double x) const noexcept { return chord(x, x_extent_, ux_, uy_); }
  [[nodiscard]] Interval chord_at_y(double y) const noexcept { return chord(y, y_extent_, uy_, ux_); }

  /// Area between the boundary arc from (x0, y0) to (x1, y1), x0 < x1, and its chord. Both points lie on the boundary
  /// and the arc is a graph over x: its `upper` side (largest y of each vertical chord) or its lower one.
  [[nodiscard]] double area_beyond_chord(double x0, double y0, double x1, double y1, bool upper) const noexcept;

 private:
  // Both directions share one derivation: (us, ut) are u's components along and across the coordinate that is given.
  [[nodiscard]] Interval extent(double us, double ut) const noexcept;
  [[nodiscard]] Interval chord(double s, const Interval& within, double us, double ut) const noexcept;

  SectionKind kind_ = SectionKind::empty;
  double vertex_x_ = 0.0, vertex_y_ = 0.0;
  double ux_ = 1.0, uy_ = 0.0;
  double e_ = 0.0, p_ = 0.0;
  double openness_ = 1.0;  // 1 - e^2: positive for an ellipse, 0 for a parabola, negative for a hyperbola
  Interval x_extent_, y_extent_;
};

}  // namespace compueye::calib
