#pragma once

#include "sim/scene/surface.hpp"

namespace compueye::sim {

/// How near and how far a surface comes. Distances from the lens tip; what it reaches with an edge counts.
struct Travel {
  double nearest_mm = 0.0;  ///< least z of any of its points
  double nearest_at_s = 0.0;
  double farthest_mm = 0.0;  ///< largest |x|, |y| or |z| of its centre
  double farthest_at_s = 0.0;
};

/// Over [0, seconds], at most a million of them. Exact where the surface does not turn; where it does, it is looked at
/// every degree or so. `object_distance_mm` is that of a surface without its own.
[[nodiscard]] Travel travel_of(const Surface& surface, double object_distance_mm, double seconds);

}  // namespace compueye::sim
