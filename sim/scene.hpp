#pragma once

#include <optional>
#include <string>

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::sim {

/// A picture on a plane perpendicular to z, centred on the axis, as a printed sheet or a display: each of its pixels is
/// a rectangle of even brightness, and beyond its edge there is no light. Its resolution is its own; the object plane's
/// pixels play no part in what the eye sees.
struct Scene {
  std::string name;
  hal::Image picture;                 ///< linear radiance, 1 = display white, finite and >= 0, row 0 on top
  double width_mm = 0.0;              ///< > 0
  double height_mm = 0.0;             ///< > 0
  std::optional<double> distance_mm;  ///< from the lens tip, > 0; absent: that of the object plane
};

/// The picture stretched over the whole object plane.
[[nodiscard]] Scene scene_on(const hal::ObjectPlane& object, std::string name, hal::Image picture);

/// Errors: mismatch (rows, columns and number of pixels disagree), out_of_range (empty, a size or distance that is not
/// above 0, a pixel that is negative, NaN or infinite, named by row and column). The place is the scene's name.
[[nodiscard]] hal::Result<void> validate(const Scene& scene);

}  // namespace compueye::sim
