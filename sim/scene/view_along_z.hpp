#pragma once

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// The scene as it stands at `t_s` seen from infinitely far before it, on the object plane's grid: light from every
/// point goes straight on along z, what is nearer hides what is behind (of what is equally near, the later one), the
/// heights of a relief shift nothing. Samples within each pixel, as fine as the finest picture but 8x8 at most. Of a
/// scene that validate() takes, lit() already.
[[nodiscard]] hal::Image view_along_z(const Scene& scene, const hal::ObjectPlane& object, double t_s);

}  // namespace compueye::sim
