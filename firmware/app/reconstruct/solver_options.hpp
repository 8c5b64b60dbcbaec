#pragma once

#include <string>

#include "firmware/app/reconstruct/reconstruct_options.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What goes with what as lines of solver, bases and constraints, straight from recon/solver_table.hpp.
[[nodiscard]] std::string solver_table_text();

/// Options that only some solvers have are given to those only, and exactly one says how far a solver may stay from y:
/// lambda, sigma, epsilon or rank. Error usage, naming the option and the solvers that take it.
[[nodiscard]] hal::Result<void> check_solver_options(const ReconstructOptions& options);

/// The solver takes this basis with this constraint. Error usage, naming the solvers that do.
[[nodiscard]] hal::Result<void> check_pair(const ProblemStatement& problem);

}  // namespace compueye::firmware
