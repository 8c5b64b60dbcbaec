#include <Eigen/SVD>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {

Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix) {
  return Eigen::BDCSVD<Eigen::MatrixXd>(matrix).singularValues();
}

void right_singular_pairs(const Eigen::MatrixXd& matrix, Eigen::VectorXd& values, Eigen::MatrixXd& vectors) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinV);
  values = svd.singularValues();
  vectors = svd.matrixV();
}

}  // namespace compueye::recon
