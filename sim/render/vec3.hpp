#pragma once

#include <cmath>

#include "hal/eye_geometry.hpp"

namespace compueye::sim {

inline hal::Vec3 operator+(const hal::Vec3& a, const hal::Vec3& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline hal::Vec3 operator-(const hal::Vec3& a, const hal::Vec3& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline hal::Vec3 operator*(double s, const hal::Vec3& a) noexcept {
  return {s * a.x, s * a.y, s * a.z};
}
inline double dot(const hal::Vec3& a, const hal::Vec3& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline hal::Vec3 cross(const hal::Vec3& a, const hal::Vec3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const hal::Vec3& a) noexcept {
  return std::sqrt(dot(a, a));
}

}  // namespace compueye::sim
