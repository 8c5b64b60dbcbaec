#include <Eigen/QR>

#include "tests/recon/reference/dense_algebra.hpp"

namespace compueye::recon::reference {

Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

}  // namespace compueye::recon::reference
