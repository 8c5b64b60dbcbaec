#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hal/image.hpp"
#include "sim/scene/motion.hpp"

namespace compueye::sim {

enum class Shape {
  plane,   ///< a printed sheet or a display
  sphere,  ///< of diameter width_mm; the picture lies on it as on a disc seen from the front
  relief,  ///< a plane whose points stand out by `heights`
};

/// How much red, green and blue count; finite, of sum 1 for a mean.
using BandWeights = std::array<double, 3>;
inline constexpr BandWeights even_bands{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};

/// Something to see: a picture of its own resolution on a shape. Each of its pixels is a rectangle of even brightness;
/// it is opaque and beyond its edge there is none of it.
struct Surface {
  std::string name;  ///< as errors name it
  Shape shape = Shape::plane;
  std::vector<hal::Image> bands;      ///< 1 (every wavelength alike) or 3 (red, green, blue) of one size; linear
                                      ///< radiance, 1 = display white, finite and >= 0, row 0 on top
  double width_mm = 0.0;              ///< > 0
  double height_mm = 0.0;             ///< > 0; a sphere's is its width
  std::optional<double> distance_mm;  ///< of its centre from the lens tip, > 0; absent: that of the object plane
  Pose pose;                          ///< centre_mm.z is `distance_mm`'s to say
  Motion motion;
  hal::Image heights;   ///< relief alone: mm out of the plane towards the eye, of any size, finite
  bool shines = false;  ///< a display, to which Scene::display applies; else lit by Scene::light alone

  [[nodiscard]] const hal::Image& picture() const noexcept { return bands.front(); }
  /// Sum of the bands times their weights; one band counts as all three.
  [[nodiscard]] hal::Image weighed(const BandWeights& weights) const;
  /// Mean of the bands: what is rendered.
  [[nodiscard]] hal::Image grey() const;
};

}  // namespace compueye::sim
