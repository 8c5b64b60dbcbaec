#pragma once

#include <cstddef>

#include "calib/estimate/estimate.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "recon/problem/progress.hpp"

namespace compueye::calib {

/// Rows that a session measured, and how far from the lens tip the display stood that they are of.
struct AtDistance {
  double distance_mm = 0.0;
  const ResponseEstimate& rows;
  double exposure_s = 1.0;  ///< of its frames; that of both is the same where it is not known
};

/// Which of two is not farther from what is asked for: 0 or 1.
[[nodiscard]] std::size_t nearer_one(double near_mm, double asked_mm, double far_mm) noexcept;

/// The rows on a plane between two that were measured, `near` < plane.distance_mm < `far`, of the same eye and pixels.
/// Nothing is taken from entries but their sigmas: what is interpolated is what makes them.
///
/// - Pose, ln half angle, ln order, place and turn of the display: linearly in the distance, all by the same share.
///   Where a session took one of them for another the other makes up for it, which shares of their own would undo.
/// - ln gain: linearly in the logarithm of the distance, which is right for any power of it.
/// - Fields: by that share, each where the line from the apex through the pixel met its own display. What lies beyond
///   the edge of one display is taken from the other alone.
/// - Sigma of an entry: of both, as independent as their noise is; and half of what the two differ by when each is
///   taken to the plane by itself, for what is not noise.
///
/// The light is that of the nearer one's exposure. A channel that is not good in one is not good. Dark levels, gamma
/// and black level: linearly; dark levels of two exposures: the nearer one's. Rows have their cone, but no fields of
/// their own; there is no lamp. The same bits for any number of `threads`. Errors: those of rows_by_threads().
[[nodiscard]] hal::Result<ResponseEstimate> between_distances(const hal::EyeGeometry& eye,
                                                              const hal::ObjectPlane& plane, const AtDistance& near,
                                                              const AtDistance& far, int threads = 1,
                                                              const recon::Progress& progress = {});

}  // namespace compueye::calib
