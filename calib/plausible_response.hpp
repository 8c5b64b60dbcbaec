#pragma once

#include <cstdint>
#include <numbers>

#include "calib/nominal.hpp"

namespace compueye::calib {

/// How a built eye departs from its drawing. Any of them may be zero.
struct BuildErrors {
  double pose_rad = 0.05 * std::numbers::pi / 180.0;  ///< std of each of two tilts of every axis, 0 .. 0.1
  double gain = 0.02;                                 ///< std of every ommatidium's gain about 1, 0 .. 0.3
  double residual = 0.03;          ///< rms over a receptive field of what multiplies its entries beside 1, 0 .. 0.3
  double residual_pitch_px = 4.0;  ///< between knots of the residual's finest structure, 1 .. 1e6
  /// The share of the half angle over which sensitivity falls from full to none, 0 .. 1; 0 is the flat top.
  double soft_edge = 0.3;
};

/// A response as a careful calibration of a real eye might find it: the nominal one with every ommatidium's axis
/// tilted, its gain off, its edge soft and its sensitivity uneven, each row in its own way, so that no symmetry is
/// left. For trying solvers and rules on rows that are neither binary nor each other's mirror images.
///
/// CSR of eye.ommatidia() x plane.pixels(), one unit = one pixel at white wholly seen at full nominal sensitivity.
/// Entry = gain times (1 + residual), clipped at 0, times the pixel's mean sensitivity over twelve nested cones, whose
/// half angles lie about acceptance / 2 so that the sensitivity falls as a smooth step and the square of the angle has
/// the same mean as over the flat top. The residual is a SmoothField over each receptive field, from
/// `residual_pitch_px` to half of the field. Entries under `least_plausible_entry` are left out. Rows that are blind in
/// the nominal response stay blind; a tilt can blind a row that saw next to nothing.
///
/// The same seed draws the same errors on every platform; entries follow to the rounding of its sine and cosine, as
/// they do in nominal_response(). With every error zero it is the nominal response but for the entries left out.
///
/// Errors: those of nominal_response(); out_of_range for an error outside its range (named); no_space.
[[nodiscard]] hal::Result<recon::Response> plausible_response(const hal::EyeGeometry& eye,
                                                              const hal::ObjectPlane& plane, const BuildErrors& errors,
                                                              std::uint64_t seed, const Progress& progress = {});

inline constexpr double least_plausible_entry = 1e-6;

}  // namespace compueye::calib
