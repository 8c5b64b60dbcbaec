#pragma once

#include "hal/eye_geometry.hpp"
#include "sim/render/picture_sums.hpp"

namespace compueye::sim {

/// Light of a picture, every point of it weighing the same, over the conic in which one cone meets its plane: mm^2
/// times intensity. The edge of the conic is walked from pixel to pixel, so the sum is exact but for the bulge of the
/// edge over its chord within a pixel, which is known to the second order and halved until it is below `tolerance_mm2`.
///
/// In the frame of the picture: `apex` x, y from its centre (mm) and z = -distance from the plane, < 0; `axis` unit.
[[nodiscard]] double light_in_section(const PictureSums& picture, const hal::Vec3& apex, const hal::Vec3& axis,
                                      double half_angle_rad, double tolerance_mm2) noexcept;

}  // namespace compueye::sim
