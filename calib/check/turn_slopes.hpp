#pragma once

#include <array>
#include <vector>

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "recon/problem/response.hpp"

namespace compueye::calib {

/// What a small turn of the eye about the centre of its dome changes in its signals.
inline constexpr std::size_t turn_axes = 3;  ///< x (nods), y (shakes), z (rolls), in hal::EyeGeometry's frame

/// d y_m / d turn, per radian, of each axis: M x turn_axes. A turned eye is a still one before a picture that turned
/// the other way: each pixel moves on the plane along the ray from the ommatidium's own apex, and the rows weigh what
/// that makes of the picture's slope. To first order, for turns that move the picture by less than a pixel. Beyond its
/// border the picture is dark. `rows` are of a picture of the plane's size.
[[nodiscard]] std::vector<std::array<double, turn_axes>> turn_slopes(const recon::Response& rows,
                                                                     const hal::EyeGeometry& eye,
                                                                     const hal::ObjectPlane& plane,
                                                                     const hal::Image& picture);

}  // namespace compueye::calib
