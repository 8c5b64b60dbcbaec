#pragma once

#include <string>

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// What goes with what. A solver that has one proximal map for the l1 term and the constraint together can only take
/// pairs whose joint map is known; composing two maps looks right and is not the map of their sum.
[[nodiscard]] bool supports(SolverKind solver, BasisKind basis, ConstraintKind constraint) noexcept;

/// The names of the solvers that take this pair, "admm, cp".
[[nodiscard]] std::string solvers_for(BasisKind basis, ConstraintKind constraint);

}  // namespace compueye::recon
