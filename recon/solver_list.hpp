#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "recon/setup/solver_row.hpp"

namespace compueye::recon {

/// Every solver there is to choose, in the order in which they are shown; the first is the default.
[[nodiscard]] std::span<const SolverKind> solvers() noexcept;

/// By its name, those for show among them; null where there is none.
[[nodiscard]] SolverKind solver_named(std::string_view name) noexcept;

/// What goes with what.
[[nodiscard]] bool supports(SolverKind solver, BasisKind basis, ConstraintKind constraint) noexcept;

/// The names of the solvers that are so, "admm, cp"; `last` stands before the last one instead of the comma.
[[nodiscard]] std::string names_of_solvers(const std::function<bool(const SolverRow&)>& wanted,
                                           std::string_view last = ", ");

/// The names of the solvers that take this pair.
[[nodiscard]] std::string solvers_for(BasisKind basis, ConstraintKind constraint);

}  // namespace compueye::recon
