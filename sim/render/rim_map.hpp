#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/render/constraint.hpp"
#include "sim/render/ray_weight.hpp"
#include "sim/render/relief_heights.hpp"

namespace compueye::sim {

/// A ball's front near its rim, where the picture's own plane is seen edge-on and light per area of the picture grows
/// without bound: x runs along the rim from an angle on, y along the meridian away from it, both 2 R tan(angle / 2), so
/// that no sine has to be taken. Light per area of the ball is smooth there.
class RimMap {
 public:
  static constexpr bool flat = false;
  static constexpr bool hides_itself = false;
  static constexpr bool has_rim = false;

  /// `centre` from the apex, mm; `angle_rad` of the cells' own middle in the picture.
  RimMap(const hal::Vec3& centre, const hal::Vec3& right, const hal::Vec3& up, const hal::Vec3& away, double radius_mm,
         double angle_rad, const RayWeight& weight) noexcept
      : centre_(centre),
        across_(std::cos(angle_rad) * right + std::sin(angle_rad) * up),
        along_(std::cos(angle_rad) * up - std::sin(angle_rad) * right),
        away_(away),
        right_(right),
        up_(up),
        radius_(radius_mm),
        angle_(angle_rad),
        weight_(weight) {}

  [[nodiscard]] bool even() const noexcept { return false; }
  [[nodiscard]] hal::Vec3 at(double x, double y) const noexcept {
    const double u = 0.5 * x / radius_, v = 0.5 * y / radius_;
    const double turn = 1.0 / (1.0 + u * u), lift = radius_ / (1.0 + v * v);
    const double out = (1.0 - v * v) * lift * turn;
    return centre_ + (1.0 - u * u) * out * across_ + 2.0 * u * out * along_ - 2.0 * v * lift * away_;
  }
  [[nodiscard]] double weight(double x, double y, const hal::Vec3& d) const noexcept {
    const double u2 = 0.25 * x * x / (radius_ * radius_), v2 = 0.25 * y * y / (radius_ * radius_);
    const double area = (1.0 - v2) / ((1.0 + u2) * (1.0 + v2) * (1.0 + v2));
    return area * weight_.either_way(d, dot(centre_ - d, d) / radius_);
  }
  [[nodiscard]] double most_weight(const Cell& cell, const hal::Vec3& d) const noexcept {
    return weight_(d, std::max(0.0, dot(centre_ - d, d)) / radius_ + length(d) * radius(cell) / radius_);
  }
  /// The map is nowhere shorter than the ball's arcs, nor these than their chords.
  [[nodiscard]] double radius(const Cell& cell) const noexcept { return half_diagonal(cell); }
  [[nodiscard]] double unevenness(const Cell& cell, const hal::Vec3& d) const noexcept {
    return radius(cell) / (0.5 * std::min(std::max(d.z, 0.0), radius_));
  }
  [[nodiscard]] double there(const Cell& /*cell*/) const noexcept { return 1.0; }

  /// Cell of this map about a cell of the picture that does not reach the ball's middle.
  [[nodiscard]] Cell about(const Cell& cell) const noexcept {
    const double c = std::cos(angle_), s = std::sin(angle_);
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const double sx : {-0.5, 0.5}) {
      for (const double sy : {-0.5, 0.5}) {
        const double x = cell.x + sx * cell.width, y = cell.y + sy * cell.height;
        const double turn = std::atan2(c * y - s * x, c * x + s * y);
        first = std::min(first, turn);
        last = std::max(last, turn);
      }
    }
    const double far = std::hypot(std::fabs(cell.x) + 0.5 * cell.width, std::fabs(cell.y) + 0.5 * cell.height);
    const double near = std::hypot(std::max(0.0, std::fabs(cell.x) - 0.5 * cell.width),
                                   std::max(0.0, std::fabs(cell.y) - 0.5 * cell.height));
    const double low = lifted(far), high = lifted(near);
    const double left = 2.0 * radius_ * std::tan(0.5 * first), right = 2.0 * radius_ * std::tan(0.5 * last);
    return {0.5 * (left + right), 0.5 * (low + high), right - left, high - low};
  }
  /// What is within a cell of the picture.
  [[nodiscard]] std::array<HalfSpace, 4> sides(const Cell& cell) const noexcept {
    const double x = dot(centre_, right_) + cell.x, y = dot(centre_, up_) + cell.y;
    const double hw = 0.5 * cell.width, hh = 0.5 * cell.height;
    return {HalfSpace{right_, hw - x}, HalfSpace{-1.0 * right_, hw + x}, HalfSpace{up_, hh - y},
            HalfSpace{-1.0 * up_, hh + y}};
  }

 private:
  [[nodiscard]] double lifted(double from_middle) const noexcept {
    return 2.0 * radius_ * std::tan(0.5 * std::acos(std::min(1.0, from_middle / radius_)));
  }

  hal::Vec3 centre_, across_, along_, away_, right_, up_;
  double radius_, angle_;
  RayWeight weight_;
};

}  // namespace compueye::sim
