#pragma once

#include <cstdint>

#include "calib/pixel_coverage.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::calib {

/// One report a row of ommatidia; return false to give up.
using Progress = recon::Progress;

/// Beyond this a response is refused before it is computed; 80 x 80 ommatidia at 60 deg take 0.1 GiB.
inline constexpr std::int64_t nominal_response_limit_bytes = std::int64_t{16} << 30;

/// The section that ommatidium (i, k) sees of the plane.
[[nodiscard]] ConeSection section_of(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, int i, int k) noexcept;

/// The response an eye has by its geometry alone, as CSR of eye.ommatidia() x plane.pixels(): a_mj is the covered
/// fraction (0 to 1) of pixel j by the section of ommatidium m's cone, apex eye.apex(), axis eye.axis(), half angle
/// acceptance / 2, with the plane z = plane.z_mm(eye). Uniform sensitivity over the acceptance angle, no losses: the
/// geometric model of Lee et al., "COMPU-EYE", Optics Express 24 (2016).
///
/// Exact to rounding, see coverage(). Entries of at most `negligible_coverage` (1e-13) are left out;
/// pixels wholly inside are exactly 1. Blind rows are kept, empty.
///
/// Errors: out_of_range for an invalid eye or plane (field and range named) or one whose distance vanishes beside the
/// radius; no_space when the response would pass `nominal_response_limit_bytes` or does not fit into memory (its size
/// is named); interrupted by `progress`.
[[nodiscard]] hal::Result<recon::Response> nominal_response(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane,
                                                            const Progress& progress = {});

}  // namespace compueye::calib
