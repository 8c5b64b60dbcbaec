#include <Eigen/SVD>

#include "tests/recon/reference/dense_algebra.hpp"

namespace compueye::recon::reference {

SingularPairs singular_pairs(const Eigen::MatrixXd& a) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

}  // namespace compueye::recon::reference
