#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "recon/reconstructor.hpp"

namespace compueye::recon::reference {

/// Psi as a dense matrix, from its definition, sharing nothing with the frame path.
[[nodiscard]] Eigen::MatrixXd basis_matrix(BasisKind basis, int image_rows, int image_cols);

struct ReferenceResult {
  std::vector<double> x;
  double objective = 0.0;
  double gap = 0.0;
  bool converged = false;
};

/// The Objective's minimiser by an interior point method in double: |Psi x| <= t turns it into a quadratic program.
/// Dense in 2 N variables (3 N for tv): for N up to a few hundred. `weights` empty: all one.
[[nodiscard]] ReferenceResult solve_reference(const Response& response, const Objective& objective,
                                              std::span<const double> y, std::span<const double> weights = {});

/// 1/2 ||W^(1/2)(Ax-y)||^2 + lambda ||Psi x||_1 in double.
[[nodiscard]] double objective_value(const Response& response, const Objective& objective, std::span<const double> y,
                                     std::span<const double> weights, std::span<const double> x);

}  // namespace compueye::recon::reference
