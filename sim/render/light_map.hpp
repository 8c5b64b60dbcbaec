#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/render/placed_surface.hpp"
#include "sim/render/ray_weight.hpp"
#include "sim/render/relief_heights.hpp"
#include "sim/render/rim_map.hpp"

namespace compueye::sim {

class PlaneMap {
 public:
  static constexpr bool flat = true;  ///< what is linear in space is linear in the picture
  static constexpr bool hides_itself = false;
  static constexpr bool has_rim = false;

  PlaneMap(const PlacedSurface& surface, const hal::Vec3& apex, const RayWeight& weight)
      : centre_(surface.centre - apex),
        right_(surface.right),
        up_(surface.up),
        facing_(dot(centre_, surface.away)),
        slope_(std::hypot(right_.z, up_.z)),
        weight_(weight) {}

  [[nodiscard]] bool seen() const noexcept { return facing_ > 0.0; }
  [[nodiscard]] bool even() const noexcept { return slope_ == 0.0 && weight_.obliquity == 0.0; }
  [[nodiscard]] hal::Vec3 at(double x, double y) const noexcept { return centre_ + x * right_ + y * up_; }
  [[nodiscard]] double weight(double /*x*/, double /*y*/, const hal::Vec3& d) const noexcept {
    return weight_(d, facing_);
  }
  /// About the largest weight in a small cell.
  [[nodiscard]] double most_weight(const Cell& /*cell*/, const hal::Vec3& d) const noexcept {
    return weight_(d, facing_);
  }
  /// No point of the cell is farther from its middle.
  [[nodiscard]] double radius(const Cell& cell) const noexcept { return half_diagonal(cell); }
  /// The cell's size over the length on which the weight changes by a factor: the distance of its nearest singularity.
  [[nodiscard]] double unevenness(const Cell& cell, const hal::Vec3& d) const noexcept {
    double scale = slope_ > 0.0 ? std::max(d.z, 0.0) / slope_ : std::numeric_limits<double>::infinity();
    if (weight_.obliquity != 0.0) scale = std::min(scale, length(d) / (1.0 + 0.25 * std::fabs(weight_.obliquity)));
    return radius(cell) / scale;
  }
  /// How much of the cell there is at all: 1 all, 0 none, else some.
  [[nodiscard]] double there(const Cell& /*cell*/) const noexcept { return 1.0; }

 private:
  hal::Vec3 centre_, right_, up_;
  double facing_, slope_;
  RayWeight weight_;
};

/// The front half of a ball, its picture a disc.
class BallMap {
 public:
  static constexpr bool flat = false;
  static constexpr bool hides_itself = false;  // HalfSpace says what is turned away
  static constexpr bool has_rim = true;

  BallMap(const PlacedSurface& surface, const hal::Vec3& apex, const RayWeight& weight)
      : centre_(surface.centre - apex),
        right_(surface.right),
        up_(surface.up),
        away_(surface.away),
        radius_(surface.radius()),
        weight_(weight) {}

  [[nodiscard]] bool seen() const noexcept { return dot(centre_, centre_) > radius_ * radius_; }
  [[nodiscard]] bool even() const noexcept { return false; }
  [[nodiscard]] hal::Vec3 at(double x, double y) const noexcept {
    return centre_ + x * right_ + y * up_ - height(x * x + y * y) * away_;
  }
  [[nodiscard]] double weight(double x, double y, const hal::Vec3& d) const noexcept {
    const double h = height(x * x + y * y);
    if (!(h > 0.0)) return 0.0;
    return weight_.either_way(
        d, dot(centre_ - d, d) / h);  // (centre - point) / h is the vector area of dx dy, from the eye
  }
  /// The cell's middle may be turned away, or beyond its rim, where the rest of the cell is not.
  [[nodiscard]] double most_weight(const Cell& cell, const hal::Vec3& d) const noexcept {
    const double size = 2.0 * half_diagonal(cell);
    const double h = std::max(height(cell.x * cell.x + cell.y * cell.y), std::sqrt(radius_ * size));
    const double turned = std::max(0.0, dot(centre_ - d, d)) / radius_ + length(d) * radius(cell) / radius_;
    return weight_(d, turned * radius_ / h);
  }
  [[nodiscard]] double radius(const Cell& cell) const noexcept {
    const double here = height(cell.x * cell.x + cell.y * cell.y), across = half_diagonal(cell);
    const double rise = std::max(height(nearest2(cell)) - here, here - height(farthest2(cell)));
    return std::sqrt(across * across + rise * rise);
  }
  /// The root in the height has its singularity at the rim, in the picture's plane.
  [[nodiscard]] double unevenness(const Cell& cell, const hal::Vec3& d) const noexcept {
    const double rim = radius_ - std::sqrt(cell.x * cell.x + cell.y * cell.y);
    return std::max(half_diagonal(cell) / std::max(rim, 0.0), radius(cell) / (0.5 * std::max(d.z, 0.0)));
  }
  [[nodiscard]] double there(const Cell& cell) const noexcept {
    if (nearest2(cell) >= radius_ * radius_) return 0.0;
    return farthest2(cell) <= radius_ * radius_ ? 1.0 : 0.5;
  }
  /// The cell meets the rim, or nearly, and is small against the ball.
  [[nodiscard]] bool at_rim(const Cell& cell) const noexcept {
    const double within = radius_ - 2.0 * half_diagonal(cell);
    return within > 0.5 * radius_ && farthest2(cell) > within * within;
  }
  [[nodiscard]] RimMap rim_map(const Cell& cell) const noexcept {
    return {centre_, right_, up_, away_, radius_, std::atan2(cell.y, cell.x), weight_};
  }

 private:
  [[nodiscard]] double height(double rho2) const noexcept { return std::sqrt(std::max(0.0, radius_ * radius_ - rho2)); }
  [[nodiscard]] static double nearest2(const Cell& c) noexcept {
    const double x = std::max(0.0, std::fabs(c.x) - 0.5 * c.width), y = std::max(0.0, std::fabs(c.y) - 0.5 * c.height);
    return x * x + y * y;
  }
  [[nodiscard]] static double farthest2(const Cell& c) noexcept {
    const double x = std::fabs(c.x) + 0.5 * c.width, y = std::fabs(c.y) + 0.5 * c.height;
    return x * x + y * y;
  }

  hal::Vec3 centre_, right_, up_, away_;
  double radius_;
  RayWeight weight_;
};

/// A plane whose points stand out.
class ReliefMap {
 public:
  static constexpr bool flat = false;
  static constexpr bool hides_itself = true;
  static constexpr bool has_rim = false;

  ReliefMap(const PlacedSurface& surface, const ReliefHeights& heights, const hal::Vec3& apex, const RayWeight& weight)
      : heights_(heights),
        centre_(surface.centre - apex),
        right_(surface.right),
        up_(surface.up),
        away_(surface.away),
        apex_{-dot(centre_, right_), -dot(centre_, up_), dot(centre_, away_)},
        slope_(std::hypot(right_.z, up_.z)),
        weight_(weight) {}

  [[nodiscard]] bool seen() const noexcept { return true; }
  [[nodiscard]] bool even() const noexcept { return false; }
  [[nodiscard]] hal::Vec3 at(double x, double y) const noexcept {
    return centre_ + x * right_ + y * up_ - heights_.patch(heights_.pixel_at(x, y), x, y).height * away_;
  }
  [[nodiscard]] double weight(double x, double y, const hal::Vec3& d) const noexcept {
    const ReliefHeights::Patch patch = heights_.patch(heights_.pixel_at(x, y), x, y);
    return weight_(d, dot(away_ + patch.slope_x * right_ + patch.slope_y * up_, d));
  }
  [[nodiscard]] double most_weight(const Cell& cell, const hal::Vec3& d) const noexcept {
    const ReliefHeights::Range range = heights_.range(cell);
    const double steep = (range.hi - range.lo) / std::min(cell.width, cell.height);
    return weight_(d, std::fabs(dot(away_, d)) + steep * length(d));
  }
  [[nodiscard]] double radius(const Cell& cell) const noexcept {
    const ReliefHeights::Range range = heights_.range(cell);
    return std::hypot(half_diagonal(cell), range.hi - range.lo);
  }
  /// Infinite where the heights are not level and the cell is larger than a pixel: there is no smooth weight then.
  [[nodiscard]] double unevenness(const Cell& cell, const hal::Vec3& d) const noexcept {
    const ReliefHeights::Range range = heights_.range(cell);
    const double rise = range.hi - range.lo, size = 2.0 * half_diagonal(cell);
    if (rise > 0.0 && !heights_.within_pixel(cell)) return std::numeric_limits<double>::infinity();
    const double steep = slope_ + rise / size + (weight_.obliquity != 0.0 ? 1.0 : 0.0);
    return std::hypot(0.5 * size, rise) * steep / std::max(d.z, 0.0);
  }
  [[nodiscard]] double there(const Cell& /*cell*/) const noexcept { return 1.0; }

  /// Positive where the relief itself does not hide the point; `cell` is the pixel, or the part of it, that holds it.
  [[nodiscard]] double clearance(const Cell& cell, double x, double y) const noexcept {
    return heights_.clearance(heights_.pixel_at(cell.x, cell.y), x, y, apex_);
  }
  /// 1: no point of the cell is hidden, -1: all are, 0: undecided. Within a pixel five points speak for all.
  [[nodiscard]] int shown(const Cell& cell) const noexcept {
    if (heights_.clear(cell, apex_)) return 1;
    if (!heights_.within_pixel(cell)) return 0;
    int clear = clearance(cell, cell.x, cell.y) > 0.0 ? 1 : 0;
    for (const double sx : {-0.5, 0.5}) {
      for (const double sy : {-0.5, 0.5}) {
        clear += clearance(cell, cell.x + sx * cell.width, cell.y + sy * cell.height) > 0.0 ? 1 : 0;
      }
    }
    return clear == 5 ? 1 : (clear == 0 ? -1 : 0);
  }

 private:
  const ReliefHeights& heights_;
  hal::Vec3 centre_, right_, up_, away_, apex_;
  double slope_;
  RayWeight weight_;
};

}  // namespace compueye::sim
