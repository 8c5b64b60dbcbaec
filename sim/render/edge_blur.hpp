#pragma once

#include "hal/image.hpp"

namespace compueye::sim {

/// The picture with every pixel edge a linear ramp over `share` (0 .. 1) of a pixel: the mean of the ramps over each of
/// `finer` x `finer` parts of a pixel. One pixel of dark is added on every side, for the outermost edges to run into:
/// (rows + 2) finer x (cols + 2) finer pixels.
[[nodiscard]] hal::Image with_blurred_edges(const hal::Image& picture, double share, int finer);

/// Parts that a pixel is cut into for a blur of that share: eight in each ramp, as long as no side of the blurred
/// picture exceeds 4096. What is left of error for every pixel edge that a cone's edge meets, of either sign, is at
/// most about 1 / (16 share parts^3) of a white pixel: beyond the renderer's tolerance for large pictures and faint
/// blurs.
[[nodiscard]] int parts_for_blur(const hal::Image& picture, double share) noexcept;

}  // namespace compueye::sim
