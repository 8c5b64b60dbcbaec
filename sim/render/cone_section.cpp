#include "sim/render/cone_section.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace compueye::sim {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Below this the two roots are so far apart that dividing by a costs too many digits of the near one.
constexpr double flat_a = 1e-4;

}  // namespace

ConeSection::ConeSection(const hal::Vec3& axis, double half_angle_rad, double depth_mm) noexcept
    : axis_(axis),
      sine_(std::sin(half_angle_rad)),
      cosine_(std::cos(half_angle_rad)),
      depth_(depth_mm),
      a_(cosine_ * cosine_ - axis.x * axis.x),
      inverse_a_(1.0 / a_) {}

// Seen along `across` the cone is a wedge of half angle atan(sin h / sqrt(cos^2 h - across^2)) about the axis; where
// the root is imaginary the cone holds the direction `across` itself and every height has a chord.
Interval ConeSection::range(double along, double across) const noexcept {
  const double a = cosine_ * cosine_ - across * across;
  if (a < 0.0) return {-infinity, infinity};
  const double middle = std::atan2(along, axis_.z);
  const double half = std::atan2(sine_, std::sqrt(a));
  constexpr double right_angle = std::numbers::pi / 2.0;
  if (middle - half >= right_angle || middle + half <= -right_angle) return {};
  return {middle - half <= -right_angle ? -infinity : depth_ * std::tan(middle - half),
          middle + half >= right_angle ? infinity : depth_ * std::tan(middle + half)};
}

// Squaring the condition gives a u^2 - 2 dx w u + (c^2 rho^2 - w^2) <= 0 with w = v dy + Z dz, rho^2 = v^2 + Z^2, whose
// quarter discriminant is c^2 (w^2 - a rho^2).
Interval ConeSection::chord(double v) const noexcept {
  const double w = v * axis_.y + depth_ * axis_.z;
  const double rho2 = v * v + depth_ * depth_;
  const double discriminant = w * w - a_ * rho2;
  if (a_ > 0.0 && (w <= 0.0 || discriminant < 0.0)) return {};
  const double middle = axis_.x * w;
  const double half = cosine_ * std::sqrt(discriminant > 0.0 ? discriminant : 0.0);
  if (a_ > flat_a) return {(middle - half) * inverse_a_, (middle + half) * inverse_a_};

  const double product = cosine_ * cosine_ * rho2 - w * w;  // a times the product of the roots
  const bool right = axis_.x > 0.0;
  if (a_ > 0.0) {
    const double far = middle + (right ? half : -half);
    const double other = product / far;
    return right ? Interval{other, far * inverse_a_} : Interval{far * inverse_a_, other};
  }
  if (w <= 0.0 && a_ == 0.0) return {};
  const double sum = right ? middle + half : middle - half;
  const double difference = right ? middle - half : middle + half;
  const double end = w > 0.0 ? product / sum : difference * inverse_a_;
  return right ? Interval{end, infinity} : Interval{-infinity, end};
}

}  // namespace compueye::sim
