#pragma once

#include "hal/result.hpp"
#include "recon/problem/plan.hpp"
#include "recon/setup/unit_choice.hpp"

namespace compueye::recon {

/// Values in their ranges, and a solver that takes this basis with this constraint. Errors: out_of_range, usage.
[[nodiscard]] hal::Result<void> check_choice(const Objective& objective, const Plan& plan);

/// Samples have to be float32 where x is of some ordinary size. `squares` is ||A||_F^2.
[[nodiscard]] hal::Result<void> check_scale(double squares, int cols);

/// lambda in `unit`, the box and rho as the solver will hold them. Outside its range rho would leave nothing of A, or
/// nothing of itself, in A A' + rho I.
[[nodiscard]] hal::Result<void> check_in_precision(double squares, const Objective& objective, const Plan& plan,
                                                   const UnitChoice& unit);

}  // namespace compueye::recon
