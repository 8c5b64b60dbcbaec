#pragma once

#include <Eigen/Core>

namespace compueye::recon::reference {

// Eigen's decompositions, each compiled in one object for the reference solver and all tests.

/// The shortest x of least ||A x - b||, by a complete orthogonal decomposition.
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// A = U diag(values) V', largest value first, with min(rows, cols) pairs.
struct SingularPairs {
  Eigen::MatrixXd u;
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};

/// By Jacobi's method, which the product uses nowhere.
[[nodiscard]] SingularPairs singular_pairs(const Eigen::MatrixXd& a);

}  // namespace compueye::recon::reference
