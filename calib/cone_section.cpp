#include "calib/cone_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace compueye::calib {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// (-1 + (1 + r) atan(sqrt r) / sqrt r) / r, whose closed form loses digits where most arcs lie: a pixel's worth of a
// large conic is nearly its chord.
double flat_arc_factor(double r) {
  double sum = 0.0;
  for (int n = 12; n >= 0; --n) sum = 2.0 / ((2.0 * n + 1.0) * (2.0 * n + 3.0)) - r * sum;
  return sum;
}

// Integral over s in [-1, 1] of the t >= 0 that solves 2 b t + (kappa / k) t^2 = k (1 - s^2): every segment of a conic
// takes this shape in the sheared frame of its chord and the direction conjugate to it.
double segment_integral(double k, double b, double kappa) {
  const double b2 = b * b;
  if (std::abs(kappa) <= 0.05 * b2) return b > 0.0 ? k / b * flat_arc_factor(kappa / b2) : 0.0;
  if (kappa > 0.0) {
    const double root = std::sqrt(kappa);
    return k * ((b2 + kappa) / root * std::atan2(root, b) - b) / kappa;
  }
  if (b <= 0.0) return 0.0;
  const double ratio = std::sqrt(-kappa) / b;
  if (ratio >= 1.0) return k / b;  // the two asymptotes themselves, reached by rounding only
  return k / b * (1.0 - (1.0 - ratio * ratio) * std::atanh(ratio) / ratio) / (ratio * ratio);
}

}  // namespace

ConeSection::ConeSection(const hal::Vec3& apex, const hal::Vec3& axis, double half_angle_rad,
                         double plane_z_mm) noexcept {
  const double height = plane_z_mm - apex.z;
  const double lean = std::hypot(axis.x, axis.y);
  const double sine = std::sin(half_angle_rad), cosine = std::cos(half_angle_rad);
  const double steepness = axis.z * cosine + lean * sine;  // cosine between the steepest ray and the normal
  if (!(height > 0.0) || !(steepness > 0.0)) return;
  if (lean > 0.0) {
    ux_ = axis.x / lean;
    uy_ = axis.y / lean;
  }
  const double reach = height * (lean * cosine - axis.z * sine) / steepness;
  vertex_x_ = apex.x + reach * ux_;
  vertex_y_ = apex.y + reach * uy_;
  e_ = lean / cosine;
  p_ = height * sine / cosine;
  // Not 1 - e^2, which has lost the digits that matter when the axis grazes the plane.
  openness_ = (axis.z - sine) * (axis.z + sine) / (cosine * cosine);
  if (!(p_ > 0.0) || !std::isfinite(vertex_x_) || !std::isfinite(vertex_y_) || !std::isfinite(p_)) return;
  kind_ = openness_ > 0.0 ? SectionKind::ellipse : openness_ < 0.0 ? SectionKind::hyperbola : SectionKind::parabola;
  x_extent_ = extent(ux_, uy_);
  y_extent_ = extent(uy_, ux_);
}

double ConeSection::area_mm2() const noexcept {
  if (empty()) return 0.0;
  return kind_ == SectionKind::ellipse ? std::numbers::pi * p_ * p_ / (openness_ * std::sqrt(openness_)) : infinity;
}

Interval ConeSection::extent(double us, double ut) const noexcept {
  const double square = openness_ + e_ * us * e_ * us;  // 1 - (e ut)^2
  if (square <= 0.0) return {-infinity, infinity};      // lines across s point into the cone: all of them meet it
  const double t = us + std::copysign(std::sqrt(square), us);
  const double near = -p_ * ut * ut / t;
  if (openness_ > 0.0) {
    const double far = p_ * t / openness_;
    return {std::min(near, far), std::max(near, far)};
  }
  return us > 0.0 ? Interval{near, infinity} : Interval{-infinity, near};
}

Interval ConeSection::chord(double s, const Interval& within, double us, double ut) const noexcept {
  if (!(s >= within.lo && s <= within.hi)) return {};
  // 0 = g t^2 + 2 b t + q for the coordinate t across.
  const double es = e_ * us, et = e_ * ut;
  const double g = -(openness_ + es * es);
  const double b = p_ * ut + es * et * s;
  const double q = s * (2.0 * p_ * us - (openness_ + et * et) * s);
  const double discriminant = p_ * p_ * ut * ut + s * (2.0 * p_ * us - openness_ * s);
  const double root = std::sqrt(std::max(discriminant, 0.0));
  const double t = -(b + std::copysign(root, b));
  if (g < 0.0) {
    if (t == 0.0) return {0.0, 0.0};
    const auto [lo, hi] = std::minmax({t / g, q / t});
    return {lo, hi};
  }
  // The line points into the cone, so it enters the front nappe once and stays.
  double enters = 0.0;
  if (g > 0.0 && t != 0.0) {
    enters = ut > 0.0 ? std::max(t / g, q / t) : std::min(t / g, q / t);
  } else if (g == 0.0) {
    if (b * ut <= 0.0) return {};  // beyond the asymptote, or on it
    enters = q / t;
  }
  return ut > 0.0 ? Interval{enters, infinity} : Interval{-infinity, enters};
}

double ConeSection::area_beyond_chord(double x0, double y0, double x1, double y1, bool upper) const noexcept {
  const double dx = 0.5 * (x1 - x0), dy = 0.5 * (y1 - y0);
  const double mx = 0.5 * (x1 + x0), my = 0.5 * (y1 + y0);
  const double along = e_ * (ux_ * dx + uy_ * dy);
  const double k = std::max(dx * dx + dy * dy - along * along, 0.0);
  const double slope = p_ * uy_ + e_ * uy_ * e_ * (ux_ * mx + uy_ * my) - my;
  return dx * segment_integral(k, upper ? -slope : slope, dx * dx * openness_);
}

}  // namespace compueye::calib
