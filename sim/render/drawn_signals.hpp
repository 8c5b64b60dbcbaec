#pragma once

#include <vector>

#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// Largest error of a drawn signal, in fully seen pixels at white: .05 LSB of the finest converter that is shipped.
inline constexpr double drawn_signal_tolerance = 1e-4;

/// The M signals (m = i * columns + k, in fully seen pixels of the object plane at white) of an eye as drawn before a
/// scene that lies flat on the object plane: the Renderer with everything off. Distances, tilts and motion of surfaces
/// are not looked at and their light adds up; neither is the scene's light, nor any effect. Errors: those of
/// Renderer::create().
[[nodiscard]] hal::Result<std::vector<double>> drawn_signals(const hal::EyeGeometry& eye,
                                                             const hal::ObjectPlane& object, const Scene& scene);

}  // namespace compueye::sim
