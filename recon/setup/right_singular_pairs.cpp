#include <Eigen/SVD>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {

void right_singular_pairs(const Eigen::MatrixXd& matrix, Eigen::VectorXd& values, Eigen::MatrixXd& vectors) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinV);
  values = svd.singularValues();
  vectors = svd.matrixV();
}

}  // namespace compueye::recon
