#include "sim/effects/looks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

using hal::Vec3;

Vec3 sum(double a, const Vec3& u, double b, const Vec3& v) noexcept {
  return {a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z};
}

/// How an ommatidium looks at the object plane.
struct Look {
  double height_mm = 0.0;  ///< of the apex over it
  double cosine = 1.0;     ///< of its axis to z
};

Look look_of(const Circumstances& c, std::size_t m) noexcept {
  const hal::EyeGeometry& eye = c.board.eye;
  const int i = static_cast<int>(m) / eye.columns, k = static_cast<int>(m) % eye.columns;
  const Vec3 apex = eye.apex(i, k);
  const double height = std::max(c.board.object.z_mm(eye) - apex.z, 1e-9);
  // Of an ommatidium that looks beside the object plane, the ray that meets its farthest corner.
  const double corner = std::hypot(c.board.object.width_mm, c.board.object.height_mm) / 2.0;
  const double farthest = (corner + std::hypot(apex.x, apex.y)) / height;
  return {height, std::max(eye.axis(i, k).z, 1.0 / std::sqrt(1.0 + farthest * farthest))};
}

/// Where a cone meets the plane in a long ellipse or none, its far end is beyond what there is to see.
constexpr double least_q = 0.15;

/// The ellipse in which a cone meets the plane, for heights of 1. Semi-axes sin h cos h / q and sin h / sqrt q with
/// q = cos^2 t - sin^2 h.
double ellipse(double cosine, double half_rad) noexcept {
  const double s = std::sin(half_rad);
  return s * s * std::cos(half_rad) / std::pow(std::max(cosine * cosine - s * s, least_q), 1.5);
}

}  // namespace

Vec3 turned(const Vec3& unit, const Vec3& towards, double angle_rad) noexcept {
  const Vec3 side = sum(1.0, towards, -dot(unit, towards), unit);
  const double length = std::sqrt(dot(side, side));
  if (!(length > 1e-12)) return unit;
  return sum(std::cos(angle_rad), unit, std::sin(angle_rad) / length, side);
}

Across across(const Vec3& unit) noexcept {
  const Vec3 least = std::fabs(unit.x) < 0.7 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
  const Vec3 side = sum(1.0, least, -dot(unit, least), unit);
  const Vec3 first = sum(1.0 / std::sqrt(dot(side, side)), side, 0.0, side);
  return {first, cross(unit, first)};
}

LookAt look_at(const Circumstances& c, int m) noexcept {
  const hal::EyeGeometry& eye = c.board.eye;
  const Look look = look_of(c, static_cast<std::size_t>(m));
  const Vec3 apex = eye.apex(m / eye.columns, m % eye.columns), axis = eye.axis(m / eye.columns, m % eye.columns);
  const double half = eye.acceptance_rad / 2.0, s = std::sin(half);
  const double q = std::max(look.cosine * look.cosine - s * s, least_q);
  const double range = look.height_mm / look.cosine;
  return {apex.x + range * axis.x, apex.y + range * axis.y, look.height_mm * s * std::cos(half) / q,
          std::numbers::pi * look.height_mm * look.height_mm * ellipse(look.cosine, half)};
}

double shifted_change_lsb(const Circumstances& c, std::span<const double> turned_rad,
                          std::span<const double> moved_mm) {
  double way2 = 0.0, grown2 = 0.0, weight = 0.0, plain_way2 = 0.0;
  const auto channels = static_cast<double>(c.preview.levels.size());
  for (std::size_t m = 0; m < c.preview.levels.size(); ++m) {
    const Look look = look_of(c, m);
    const double sine = std::sqrt(1.0 - std::min(look.cosine * look.cosine, 1.0));
    const double range = look.height_mm / look.cosine, level = c.preview.levels[m];
    const double way = range / look.cosine * turned_rad[m] + moved_mm[m] / look.cosine;
    const double grown = 3.0 * sine / look.cosine * turned_rad[m] + 2.0 * moved_mm[m] / range;
    // Where there is no light there is no gradient either: ways count by the light that is there.
    way2 += level * level * way * way;
    weight += level * level;
    plain_way2 += way * way / channels;
    grown2 += level * level * grown * grown / channels;
  }
  const double typical2 = weight > 0.0 ? way2 / weight : plain_way2;
  // Ways are longer on what stands behind the object plane, and pictures denser on what turns away from it.
  const double uneven = c.preview.flat_change ? 2.0 : 1.0;
  const double change = uneven * steepness_lsb_per_mm(c) * std::sqrt(typical2) + std::sqrt(grown2);
  return margin * std::min(change, 2.0 * c.preview.rms);
}

double widened_change_lsb(const Circumstances& c, std::span<const double> half_rad) {
  double level2 = 0.0, share2 = 0.0;
  const double drawn = c.board.eye.acceptance_rad / 2.0, radius = look_radius_mm(c);
  const auto channels = static_cast<double>(c.preview.levels.size());
  for (std::size_t m = 0; m < c.preview.levels.size(); ++m) {
    const double cosine = look_of(c, m).cosine;
    const double share = ellipse(cosine, half_rad[m]) / ellipse(cosine, drawn) - 1.0;
    level2 += std::pow(share * c.preview.levels[m], 2) / channels;
    share2 += share * share / channels;
  }
  const double ring = std::sqrt(share2) * radius * radius / 4.0 * c.preview.laplacian_rms;
  return margin * (std::sqrt(level2) + std::min(ring, std::sqrt(level2)));
}

}  // namespace compueye::sim
