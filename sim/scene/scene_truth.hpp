#pragma once

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// What a perfect reconstruction of the scene as it stands at `t_s` shows on the object plane's grid: the mean
/// intensity over each pixel's rectangle, weighted by area, black beyond the scene's edge; lit by Light::level, and the
/// mean of the bands. Bit for bit the picture itself where resolution and size agree. Lengths are compared in mm on
/// both planes: a scene at another distance is not scaled, because every ommatidium would scale it differently. A scene
/// of more than one upright sheet in the middle is seen along z (view_along_z.hpp). What display, lamp and mains do to
/// the light is left aside. Errors: those of validate(scene) and of the plane.
[[nodiscard]] hal::Result<hal::Image> scene_truth(const Scene& scene, const hal::ObjectPlane& object, double t_s = 0.0);

}  // namespace compueye::sim
