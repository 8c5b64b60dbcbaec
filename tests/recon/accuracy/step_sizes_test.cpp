#include "recon/setup/step_sizes.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/dense_algebra.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

double norm(const Eigen::MatrixXd& matrix) {
  return recon::reference::singular_pairs(matrix).values[0];
}

}  // namespace

TEST_CASE("the gradient step's bound lies just above the squared norm") {
  Random random(101);
  for (int trial = 0; trial < 20; ++trial) {
    const auto a = random_response(random, 1 + random.below(20), 1 + random.below(30), 0.6);
    const double exact = norm(dense_matrix(a)) * norm(dense_matrix(a));
    const double bound = recon::squared_norm_bound(a);
    CHECK(bound >= exact);
    CHECK(bound <= 1.02 * exact + 1e-300);
  }
}

TEST_CASE("the gradient step's bound holds where the leading vector is orthogonal to every likely start") {
  Random random(103);
  constexpr Eigen::Index rows = 12, cols = 20;
  Eigen::VectorXd ripple(cols);
  for (Eigen::Index k = 0; k < cols; ++k) ripple[k] = 1.0 + 0.1 * std::sin(0.7 * static_cast<double>(k));
  for (const Eigen::VectorXd& start : {ripple, Eigen::VectorXd(Eigen::VectorXd::Ones(cols))}) {
    Eigen::VectorXd leading(cols);
    for (double& v : leading) v = random.normal();
    leading -= leading.dot(start) / start.squaredNorm() * start;
    Eigen::MatrixXd matrix(rows, cols);
    for (Eigen::Index k = 0; k < matrix.size(); ++k) matrix.data()[k] = 0.1 * random.normal();
    // The other rows see nothing of it, and the start none of the first.
    matrix -= matrix * leading * leading.transpose() / leading.squaredNorm();
    matrix.row(0) = 12.0 * leading.transpose() / leading.norm();
    matrix.row(1) += 6.0 * start.transpose() / start.norm();
    std::vector<double> values;
    for (Eigen::Index m = 0; m < rows; ++m) {
      for (Eigen::Index n = 0; n < cols; ++n) values.push_back(matrix(m, n));
    }
    const double exact = norm(matrix) * norm(matrix);
    const double bound = recon::squared_norm_bound(recon::Response::from_dense(rows, cols, values).value());
    CHECK(bound >= exact);
    CHECK(bound <= 1.02 * exact);
  }
}

TEST_CASE("primal-dual steps keep the preconditioned operator's norm at one or below") {
  Random random(102);
  for (const double unit : {1e-3, 1.0, 1e4}) {
    for (int trial = 0; trial < 10; ++trial) {
      const auto any = random_response(random, 12, 20, 0.5);
      const auto seeing = any.seeing_rows();
      const auto a = any.select_rows(seeing, std::vector<double>(seeing.size(), unit));
      const auto steps = recon::primal_dual_steps(a, 1.0);
      Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(a.rows() + a.cols(), a.cols());
      const Eigen::MatrixXd matrix = dense_matrix(a);
      for (int n = 0; n < a.cols(); ++n) {
        const double primal = std::sqrt(steps.primal[static_cast<std::size_t>(n)]);
        for (int m = 0; m < a.rows(); ++m) {
          scaled(m, n) = std::sqrt(steps.dual[static_cast<std::size_t>(m)]) * matrix(m, n) * primal;
        }
        scaled(a.rows() + n, n) = std::sqrt(steps.basis) * primal;
      }
      CHECK(norm(scaled) <= 1.0 + 1e-12);
    }
  }
}
