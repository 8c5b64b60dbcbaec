#pragma once

#include <array>

#include "hal/vec3.hpp"
#include "sim/scene/surface.hpp"

namespace compueye::sim {

/// A surface where it stands at one time, in the eye's frame.
struct PlacedSurface {
  Shape shape = Shape::plane;
  hal::Vec3 centre, right, up, away;  ///< unit vectors of the picture; away = right x up, from the eye at no turn
  double half_width = 0.0, half_height = 0.0;
  double reach = 0.0;  ///< no point of it is farther from its centre
  bool present = true;

  PlacedSurface() = default;
  PlacedSurface(const Surface& surface, const Pose& pose);

  /// z of its point that is nearest to the plane z = 0.
  [[nodiscard]] double nearest_z() const noexcept;
  [[nodiscard]] double radius() const noexcept { return half_width; }
  /// Corners of a plane, counter-clockwise as seen from its front.
  [[nodiscard]] std::array<hal::Vec3, 4> corners() const noexcept;
  /// The same place and turn.
  [[nodiscard]] bool stands_as(const PlacedSurface& other) const noexcept;
};

}  // namespace compueye::sim
