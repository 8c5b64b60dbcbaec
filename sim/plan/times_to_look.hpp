#pragma once

#include <vector>

#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// When to look at a scene to see what its motion can change, s after it began: at 0 first; where each surface that
/// moves comes nearest to the eye's axis, where its path is farthest from its place, and a quarter and 137.5 degrees
/// into its turn; and at four times within what is judged that keep no beat with anything that has one. Of a still
/// scene its beginning alone. Of more than sixteen surfaces that move only the first have times of their own.
[[nodiscard]] std::vector<double> times_to_look(const Scene& scene);

}  // namespace compueye::sim
