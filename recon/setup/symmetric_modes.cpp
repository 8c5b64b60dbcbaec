#include "recon/setup/symmetric_modes.hpp"

#include <Eigen/Eigenvalues>

namespace compueye::recon {

SymmetricModes symmetric_modes(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

}  // namespace compueye::recon
