#pragma once

#include <optional>

#include "sim/scene/surface.hpp"

namespace compueye::sim {

/// How near and how far a surface comes. Distances from the lens tip; what it reaches with an edge counts.
struct Travel {
  double nearest_mm = 0.0;             ///< least z of any of its points
  std::optional<double> inside_at_s;   ///< when that is first found at 0 or less
  double farthest_mm = 0.0;            ///< largest |x|, |y| or |z| of its centre
  std::optional<double> too_far_at_s;  ///< when that is first found beyond `limit_mm`
};

/// Over [0, seconds], at most a million of them. Exact where the surface does not turn; where it does, it is looked at
/// every degree or so. `object_distance_mm` is that of a surface without its own.
[[nodiscard]] Travel travel_of(const Surface& surface, double object_distance_mm, double seconds, double limit_mm);

}  // namespace compueye::sim
