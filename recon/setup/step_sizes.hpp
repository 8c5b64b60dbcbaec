#pragma once

#include <vector>

#include "recon/core/bases/basis.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// A bound of ||A||_2^2 for gradient steps: the power method on A'A from a positive start and from a random one,
/// each until it moves by less than 1e-6, the larger plus 1 %. 0 for an all-zero A.
[[nodiscard]] double squared_norm_bound(const Response& response);

/// Steps of the primal-dual method: primal_j = 1 / (b (sum_i |a_ij| + k)) and dual_i = b / sum_j |a_ij| for A, and
/// b k / ||Psi||^2 for the basis, with k the mean column sum and b a balance between primal and dual that is a fixed
/// share of the mean row sum, so that the iterates do not depend on the unit of A. They satisfy
/// ||S^(1/2) [A; Psi] T^(1/2)|| <= 1 (Pock & Chambolle 2011, lemma 2), which is what convergence asks for.
struct PrimalDualSteps {
  std::vector<double> primal;  ///< N
  std::vector<double> dual;    ///< M
  double basis = 0.0;
};

/// `basis_squared_norm` is core::Basis::squared_norm(). No row of `seeing` is all zero.
[[nodiscard]] PrimalDualSteps primal_dual_steps(const Response& seeing, double basis_squared_norm);

}  // namespace compueye::recon
