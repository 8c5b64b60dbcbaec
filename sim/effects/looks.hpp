#pragma once

#include <span>

#include "sim/effects/circumstances.hpp"

namespace compueye::sim {

/// About a vector `towards` another; the angle is that between what is given and what comes out. The same where the two
/// are parallel.
[[nodiscard]] hal::Vec3 turned(const hal::Vec3& unit, const hal::Vec3& towards, double angle_rad) noexcept;

/// Two unit vectors across a unit vector, and across each other.
struct Across {
  hal::Vec3 first, second;
};
[[nodiscard]] Across across(const hal::Vec3& unit) noexcept;

/// Bound of what it changes when ommatidium m looks aside by `turned_rad[m]` and its apex stands aside by
/// `moved_mm[m]`, rms over the channels, LSB. Levels follow their gradient along the way that the look goes on the
/// object plane: range / cos t of a turn, t the angle of the axis to z; the area that is seen grows by 3 tan t of a
/// turn, and by 2 / range of a step. Never more than twice the levels: there is no more to lose or to win.
[[nodiscard]] double shifted_change_lsb(const Circumstances& c, std::span<const double> turned_rad,
                                        std::span<const double> moved_mm);

/// Bound of what it changes when ommatidium m sees a cone of half angle `half_rad[m]` instead of the drawn one. Levels
/// grow as the area of the ellipse in which the cone meets the object plane; the ring that comes in is brighter than
/// the mean within by (radius^2 / 8) times the sum of the second derivatives.
[[nodiscard]] double widened_change_lsb(const Circumstances& c, std::span<const double> half_rad);

/// Where on the object plane ommatidium m looks: right and up of the axis of the eye, and the radius of what it sees
/// there along its longer side.
struct LookAt {
  double x_mm = 0.0, y_mm = 0.0, radius_mm = 0.0;
  double area_mm2 = 0.0;
};
[[nodiscard]] LookAt look_at(const Circumstances& c, int m) noexcept;

/// Widest half angle that a cone may have.
inline constexpr double widest_half_rad = 1.0471;

}  // namespace compueye::sim
