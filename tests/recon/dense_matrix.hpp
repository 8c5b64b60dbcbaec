#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "recon/problem/response.hpp"

namespace compueye::tests {

inline Eigen::MatrixXd dense_matrix(const recon::Response& a) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(a.rows(), a.cols());
  for (int m = 0; m < a.rows(); ++m) {
    a.for_each_in_row(m, [&](std::int32_t n, double v) { matrix(m, n) = v; });
  }
  return matrix;
}

}  // namespace compueye::tests
