#include "sim/render/placed_surface.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::sim {
namespace {

bool same(const hal::Vec3& a, const hal::Vec3& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Largest and smallest height of a relief.
std::array<double, 2> height_range(const hal::Image& heights) {
  if (heights.pixels.empty()) return {0.0, 0.0};
  const auto [lo, hi] = std::minmax_element(heights.pixels.begin(), heights.pixels.end());
  return {static_cast<double>(*lo), static_cast<double>(*hi)};
}

}  // namespace

PlacedSurface::PlacedSurface(const Surface& surface, const Pose& pose)
    : shape(surface.shape),
      centre(pose.centre_mm),
      right(pose.right()),
      up(pose.up()),
      away(cross(right, up)),
      half_width(surface.width_mm / 2.0),
      half_height(surface.shape == Shape::sphere ? half_width : surface.height_mm / 2.0) {
  reach = shape == Shape::sphere ? half_width : std::hypot(half_width, half_height);
  if (shape == Shape::relief) {
    const auto [lo, hi] = height_range(surface.heights);
    reach = std::hypot(reach, std::max(std::fabs(lo), std::fabs(hi)));
  }
}

double PlacedSurface::nearest_z() const noexcept {
  if (shape == Shape::sphere) return centre.z - half_width;
  const double flat = half_width * std::fabs(right.z) + half_height * std::fabs(up.z);
  const double rest2 = reach * reach - half_width * half_width - half_height * half_height;
  const double relief = shape == Shape::relief ? std::sqrt(std::max(0.0, rest2)) * std::fabs(away.z) : 0.0;
  return centre.z - flat - relief;
}

std::array<hal::Vec3, 4> PlacedSurface::corners() const noexcept {
  const hal::Vec3 r = half_width * right, u = half_height * up;
  return {centre - r - u, centre + r - u, centre + r + u, centre - r + u};
}

bool PlacedSurface::stands_as(const PlacedSurface& other) const noexcept {
  return present == other.present && same(centre, other.centre) && same(right, other.right) && same(up, other.up);
}

}  // namespace compueye::sim
