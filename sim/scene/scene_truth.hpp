#pragma once

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// What a perfect reconstruction of the scene on the object plane's grid shows: the mean intensity over each pixel's
/// rectangle, weighted by area, black beyond the scene's edge. Bit for bit the picture itself where resolution and size
/// agree. Lengths are compared in mm on both planes: a scene at another distance is not scaled, because every
/// ommatidium would scale it differently. Errors: those of validate(scene) and of the plane.
[[nodiscard]] hal::Result<hal::Image> scene_truth(const Scene& scene, const hal::ObjectPlane& object);

}  // namespace compueye::sim
