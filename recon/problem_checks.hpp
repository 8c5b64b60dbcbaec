#pragma once

#include "hal/result.hpp"
#include "recon/problem/plan.hpp"

namespace compueye::recon {

/// Values in their ranges, and a solver that takes this basis with this constraint. Errors: out_of_range, usage.
[[nodiscard]] hal::Result<void> check_choice(const Objective& objective, const Plan& plan);

/// With x in units of white and y in those of A, squares of A's entries, of residuals and of the factor's entries all
/// have to stay clear of float32's ends. `squares` is ||A||_F^2.
[[nodiscard]] hal::Result<void> check_scale(double squares, int cols);

/// lambda, the box and rho as the solver will hold them. Outside its range rho would leave nothing of A, or nothing of
/// itself, in A A' + rho I.
[[nodiscard]] hal::Result<void> check_in_precision(double squares, const Objective& objective, const Plan& plan);

}  // namespace compueye::recon
