#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "hal/eye_geometry.hpp"
#include "tests/hal/units.hpp"

/// The cone itself, as the independent check of calib/cone_section and calib/pixel_coverage: a point of the plane is
/// seen when the angle between its ray and the axis is at most the half angle. No conic, no chord formula, nothing
/// of the code under test.
namespace compueye::calib::reference {

struct Cone {
  hal::Vec3 apex, axis;
  double half_angle_rad = 0.0;
  double plane_z = 0.0;
};

/// A pixel in the coordinates of the plane.
struct Pixel {
  double x0 = 0.0, x1 = 0.0, y0 = 0.0, y1 = 0.0;
};

template <class Real>
Real angle_to_axis(const Cone& c, Real x, Real y) {
  const Real vx = x - Real(c.apex.x), vy = y - Real(c.apex.y), vz = Real(c.plane_z) - Real(c.apex.z);
  const Real ax = c.axis.x, ay = c.axis.y, az = c.axis.z;
  const Real cx = vy * az - vz * ay, cy = vz * ax - vx * az, cz = vx * ay - vy * ax;
  return std::atan2(std::sqrt(cx * cx + cy * cy + cz * cz), vx * ax + vy * ay + vz * az);
}

/// Share of n x n sample points of the pixel that the cone sees. The sights of a convex cone on a line are one
/// interval, so each column of samples is wrong by less than 1/n of its length, and the midpoint rule over columns adds
/// at most half the variation of a hump of height 1 per n: within 2/n of the covered fraction, always.
inline double sampled_coverage(const Cone& cone, const Pixel& p, int n) {
  int seen = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = p.x0 + (p.x1 - p.x0) * (i + 0.5) / n, y = p.y0 + (p.y1 - p.y0) * (j + 0.5) / n;
      if (angle_to_axis(cone, x, y) <= cone.half_angle_rad) ++seen;
    }
  }
  return static_cast<double>(seen) / (static_cast<double>(n) * n);
}

/// Covered fraction by tanh-sinh quadrature, in extended precision, of chord lengths found by bisection. The line over
/// which it integrates is cut wherever the border of what the cone sees leaves the pixel, those places being found by
/// bisection too, so that the integrand is smooth inside each piece and at worst a square root at its ends.
class QuadratureCoverage {
 public:
  QuadratureCoverage(const Cone& cone, const Pixel& pixel)
      : cone_(cone), left_(pixel.x0), right_(pixel.x1), bottom_(pixel.y0), top_(pixel.y1) {}

  /// `steps` per unit of the transformed variable; 12 give about 1e-13, twice as many the precision of the type.
  [[nodiscard]] double fraction(int steps) const {
    const std::vector<long double> cuts = pieces();
    long double sum = 0.0L;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) sum += tanh_sinh(cuts[i], cuts[i + 1], steps);
    return static_cast<double>(sum / ((right_ - left_) * (top_ - bottom_)));
  }

 private:
  using Real = long double;

  [[nodiscard]] Real excess(Real x, Real y) const { return angle_to_axis(cone_, x, y) - Real(cone_.half_angle_rad); }

  // The least value of a function with one valley; stops early at a place where it is not positive.
  template <class Function>
  static Real valley(Real lo, Real hi, Function&& f) {
    const Real golden = (std::sqrt(Real(5)) - 1) / 2;
    Real a = hi - golden * (hi - lo), b = lo + golden * (hi - lo);
    Real at_a = f(a), at_b = f(b);
    for (int i = 0; i < 95 && at_a > 0 && at_b > 0; ++i) {
      if (at_a < at_b) {
        hi = b;
        b = a;
        at_b = at_a;
        a = hi - golden * (hi - lo);
        at_a = f(a);
      } else {
        lo = a;
        a = b;
        at_a = at_b;
        b = lo + golden * (hi - lo);
        at_b = f(b);
      }
    }
    const Real at_lo = f(lo), at_hi = f(hi);
    const Real least = std::min({at_a, at_b, at_lo, at_hi});
    return least == at_a ? a : least == at_b ? b : least == at_lo ? lo : hi;
  }

  // The last place from `inside` towards `beyond` where f is not positive.
  template <class Function>
  static Real border(Real inside, Real beyond, Function&& f) {
    if (f(beyond) <= 0) return beyond;
    for (int i = 0; i < 70; ++i) {
      const Real middle = (inside + beyond) / 2;
      (f(middle) <= 0 ? inside : beyond) = middle;
    }
    return inside;
  }

  // The interval of [lo, hi] where f is not positive, by its two ends; nothing if there is none.
  template <class Function>
  static std::optional<std::array<Real, 2>> seen(Real lo, Real hi, Function&& f) {
    const Real inside = valley(lo, hi, f);
    if (f(inside) > 0) return std::nullopt;
    return std::array<Real, 2>{border(inside, lo, f), border(inside, hi, f)};
  }

  [[nodiscard]] Real least_on_line(Real x) const {
    const auto on_line = [&](Real y) { return excess(x, y); };
    return on_line(valley(bottom_, top_, on_line));
  }

  [[nodiscard]] Real chord_length(Real x) const {
    const auto ends = seen(bottom_, top_, [&](Real y) { return excess(x, y); });
    return ends ? (*ends)[1] - (*ends)[0] : Real(0);
  }

  [[nodiscard]] std::vector<Real> pieces() const {
    const auto extent = seen(left_, right_, [&](Real x) { return least_on_line(x); });
    if (!extent) return {};
    std::vector<Real> cuts(extent->begin(), extent->end());
    for (const Real y : {bottom_, top_}) {
      const auto ends = seen(left_, right_, [&](Real x) { return excess(x, y); });
      if (ends) cuts.insert(cuts.end(), ends->begin(), ends->end());
    }
    std::sort(cuts.begin(), cuts.end());
    return cuts;
  }

  [[nodiscard]] Real tanh_sinh(Real a, Real b, int steps) const {
    const Real half_pi = std::numbers::pi_v<Real> / 2, half = (b - a) / 2;
    Real sum = half_pi * chord_length((a + b) / 2);
    for (int n = 1; n <= 3.4 * steps; ++n) {
      const Real t = Real(n) / steps;
      const Real u = half_pi * std::sinh(t);
      const Real from_end = half * std::exp(-u) / std::cosh(u);
      const Real weight = half_pi * std::cosh(t) / (std::cosh(u) * std::cosh(u));
      sum += weight * (chord_length(a + from_end) + chord_length(b - from_end));
    }
    return half * sum / steps;
  }

  Cone cone_;
  Real left_, right_, bottom_, top_;
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lo, double hi) { return lo + (hi - lo) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53); }
  double log_uniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }

 private:
  std::mt19937_64 engine_;
};

using compueye::test::deg;

/// A cone that leans `tilt_rad` towards azimuth `lean_rad`, its apex `height` in front of the plane.
inline Cone leaning_cone(double tilt_rad, double lean_rad, double half_angle_rad, double height) {
  return {{0.3, -0.2, 8.0},
          {std::sin(tilt_rad) * std::cos(lean_rad), std::sin(tilt_rad) * std::sin(lean_rad), std::cos(tilt_rad)},
          half_angle_rad,
          8.0 + height};
}

/// A pixel of the given size around the point where one ray of the cone's surface, at `azimuth_rad` about its axis,
/// meets the plane; nothing if that ray does not come down within 100 heights.
inline std::optional<Pixel> border_pixel(const Cone& c, double azimuth_rad, double width, double height,
                                         Random& random) {
  const hal::Vec3 d = c.axis;
  const hal::Vec3 other = std::abs(d.x) < 0.7 ? hal::Vec3{1.0, 0.0, 0.0} : hal::Vec3{0.0, 1.0, 0.0};
  hal::Vec3 a{d.y * other.z - d.z * other.y, d.z * other.x - d.x * other.z, d.x * other.y - d.y * other.x};
  const double length = std::hypot(a.x, a.y, a.z);
  a = {a.x / length, a.y / length, a.z / length};
  const hal::Vec3 b{d.y * a.z - d.z * a.y, d.z * a.x - d.x * a.z, d.x * a.y - d.y * a.x};
  const double cosine = std::cos(c.half_angle_rad), sine = std::sin(c.half_angle_rad);
  const double u = sine * std::cos(azimuth_rad), v = sine * std::sin(azimuth_rad);
  const hal::Vec3 ray{cosine * d.x + u * a.x + v * b.x, cosine * d.y + u * a.y + v * b.y,
                      cosine * d.z + u * a.z + v * b.z};
  if (ray.z < 0.01) return std::nullopt;
  const double stretch = (c.plane_z - c.apex.z) / ray.z;
  const double x0 = c.apex.x + stretch * ray.x - width * random.uniform(0.02, 0.98);
  const double y0 = c.apex.y + stretch * ray.y - height * random.uniform(0.02, 0.98);
  return Pixel{x0, x0 + width, y0, y0 + height};
}

}  // namespace compueye::calib::reference
