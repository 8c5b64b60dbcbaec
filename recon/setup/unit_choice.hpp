#pragma once

#include "recon/core/frame/frame_unit.hpp"
#include "recon/problem/plan.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// Powers of two that a problem is solved in: A times 2^response, x times 2^picture.
struct UnitChoice {
  int response = 0;
  int picture = 0;

  [[nodiscard]] core::FrameUnit of_frames() const noexcept;
  /// With A in its unit and x as it is: lambda, and rho, go with the square of A, epsilon with A.
  [[nodiscard]] Objective of_response(Objective objective) const noexcept;
  [[nodiscard]] double squared(double rho) const noexcept;    ///< rho in the unit of A
  [[nodiscard]] double unsquared(double rho) const noexcept;  ///< and back
};

/// The exponent that brings the columns' root mean square norm to 1 .. 2, where it is outside 2^-16 .. 2^16: of
/// ||A||_F^2 and the number of columns. An ordinary A is not copied.
[[nodiscard]] int response_exponent(double squares, int cols) noexcept;

/// Both. How bright x is nobody knows at set-up, but lambda is some share of |A'y|, and epsilon one of |y|: x is
/// brought to where lambda is 2^-20 of a column's norm, or epsilon 2^-10, as far as a box stays within 2^-40 and 2^40.
/// Shares from 1e-12 to 1e12 then stay far from where float32 ends (recon/core/parts/proximal.hpp flushes what is below
/// 1e-20). Where lambda is a ratio of variances, or there is none, each frame chooses by its own samples
/// (FrameProblem::homogeneous).
[[nodiscard]] UnitChoice choose_unit(double squares, int cols, const Objective& objective, const Plan& plan) noexcept;

}  // namespace compueye::recon
