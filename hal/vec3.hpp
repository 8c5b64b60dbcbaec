#pragma once

#include <cmath>

namespace compueye::hal {

/// A point or a direction of the eye frame (see EyeGeometry); points in mm.
struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;
};

[[nodiscard]] inline Vec3 operator+(const Vec3& a, const Vec3& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] inline Vec3 operator-(const Vec3& a, const Vec3& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] inline Vec3 operator*(double s, const Vec3& a) noexcept {
  return {s * a.x, s * a.y, s * a.z};
}
[[nodiscard]] inline double dot(const Vec3& a, const Vec3& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double length(const Vec3& a) noexcept {
  return std::sqrt(dot(a, a));
}
/// The direction of `v`, which is not 0.
[[nodiscard]] inline Vec3 unit(const Vec3& v) noexcept {
  const double all = length(v);
  return {v.x / all, v.y / all, v.z / all};
}

}  // namespace compueye::hal
