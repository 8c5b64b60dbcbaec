#pragma once

#include <vector>

#include "hal/eye_geometry.hpp"

namespace compueye::sim {

/// Where a surface is and how it is turned. At no turn it stands parallel to the object plane, its picture upright.
/// It is rolled about its own normal first, then leant about x, then tilted about y.
struct Pose {
  hal::Vec3 centre_mm;    ///< x right, y up of the axis of the eye; z from the lens tip, > 0
  double tilt_rad = 0.0;  ///< about y; > 0: the right edge is farther
  double lean_rad = 0.0;  ///< about x; > 0: the upper edge is farther
  double roll_rad = 0.0;  ///< about the normal; > 0: counter-clockwise as the eye sees it

  /// Unit vectors of the surface in the eye's frame: its picture's right, its picture's up.
  [[nodiscard]] hal::Vec3 right() const noexcept;
  [[nodiscard]] hal::Vec3 up() const noexcept;
};

struct Waypoint {
  double t_s = 0.0;     ///< after the motion's start, ascending
  hal::Vec3 offset_mm;  ///< from the surface's own place
};

/// How a surface moves, from `start_s` on; still before.
struct Motion {
  double start_s = 0.0;
  hal::Vec3 velocity_mm_per_s;
  double tilt_rad_per_s = 0.0, lean_rad_per_s = 0.0, roll_rad_per_s = 0.0;
  std::vector<Waypoint> path;  ///< added to the velocity; linear between, standing still after the last
  bool repeats = false;        ///< the path begins anew after its last waypoint
  double steps_hz = 0.0;       ///< stands still between so many steps a second from the scene's beginning; 0: flows

  [[nodiscard]] bool still() const noexcept;
  /// At `t_s` after the scene began.
  [[nodiscard]] Pose moved(const Pose& from, double t_s) const noexcept;
  /// Largest speed of the surface's centre and largest turning, over [0, duration_s]: mm/s and rad/s.
  [[nodiscard]] double speed_mm_per_s() const noexcept;
  [[nodiscard]] double turning_rad_per_s() const noexcept;
};

}  // namespace compueye::sim
