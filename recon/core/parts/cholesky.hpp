#pragma once

#include <cstddef>

namespace compueye::recon::core {

/// Factors the symmetric positive definite `a` (order x order, row-major, lower triangle read) in place into L with
/// a = L L'. Returns false, leaving `a` undefined, when a pivot is not positive or not finite.
[[nodiscard]] bool cholesky_factor(double* a, std::size_t order) noexcept;

/// Solves L L' x = b in place.
void cholesky_solve(const double* l, std::size_t order, double* b) noexcept;

}  // namespace compueye::recon::core
