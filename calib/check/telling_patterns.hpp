#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "recon/problem/response.hpp"

namespace compueye::calib {

/// Which `count` of the pictures tell most of a turn about all three axes, beside a white one: each is the one whose
/// slopes, added to those taken so far, have the largest determinant. Ascending; all of them where there are no more.
[[nodiscard]] std::vector<std::size_t> telling_patterns(const recon::Response& rows, const hal::EyeGeometry& eye,
                                                        const hal::ObjectPlane& plane,
                                                        std::span<const hal::Image> pictures, std::size_t count);

}  // namespace compueye::calib
