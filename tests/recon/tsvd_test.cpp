#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "recon/setup/singular_modes.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/reference/dense_algebra.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/recon/solver_problems.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::solver_named;

namespace {

/// Mirror images on both axes of a random quadrant's rows.
recon::Response symmetric_response(int side) {
  Random random(17);
  const int n = side * side;
  std::vector<double> values;
  for (int k = 0; k < n / 4; ++k) {
    const auto row = random_vector(random, n, 0.0, 1.0);
    for (const auto& [flip_rows, flip_cols] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
      for (int r = 0; r < side; ++r) {
        for (int c = 0; c < side; ++c) {
          const int from_r = flip_rows ? side - 1 - r : r, from_c = flip_cols ? side - 1 - c : c;
          values.push_back(row[static_cast<std::size_t>(from_r * side + from_c)]);
        }
      }
    }
  }
  return recon::Response::from_dense(n / 4 * 4, n, values).value().with_image(side, side).value();
}

SolvedFrame solve_tsvd(const recon::Response& a, int rank, const std::vector<double>& y,
                       const std::vector<float>& weights = {}) {
  recon::Plan plan;
  plan.solver = solver_named("tsvd");
  plan.rank = rank;
  plan.precision = recon::Precision::f64;
  plan.max_reweighted = a.rows();
  return solve_frame(recon::Reconstructor::create(a, {}, plan).value(), to_float(y), weights);
}

}  // namespace

TEST_CASE("singular pairs are those of a dense decomposition, parity classes or none") {
  Random random(18);
  for (const recon::Response& a : {symmetric_response(6), random_response(random, 12, Picture{6, 6}, 0.5)}) {
    const auto svd = recon::reference::singular_pairs(dense_matrix(a));
    const auto modes = recon::singular_modes(a, 10, 0.0, {});
    REQUIRE(modes.has_value());
    REQUIRE(modes->values.size() == 10);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> left(
        modes->left.data(), a.rows(), 10);
    CHECK((left.transpose() * left - Eigen::MatrixXd::Identity(10, 10)).norm() < 1e-12);
    for (Eigen::Index k = 0; k < 10; ++k) {
      const double s = modes->values[static_cast<std::size_t>(k)];
      CHECK(s == doctest::Approx(svd.values[k]).epsilon(1e-9));
      CHECK((dense_matrix(a) * dense_matrix(a).transpose() * left.col(k) - s * s * left.col(k)).norm() < 1e-9 * s * s);
    }
  }
}

TEST_CASE("tsvd is the truncated decomposition's answer at every rank") {
  Random random(19);
  for (const recon::Response& a : {symmetric_response(6), random_response(random, 14, Picture{6, 6}, 0.6)}) {
    const auto y = random_vector(random, a.rows(), 0.0, 3.0);
    const auto svd = recon::reference::singular_pairs(dense_matrix(a));
    const auto yf = to_float(y);
    for (const int rank : {1, 2, 7, 12}) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(36);
      for (int k = 0; k < rank; ++k) {
        double product = 0.0;
        for (int m = 0; m < a.rows(); ++m)
          product += svd.u(m, k) * static_cast<double>(yf[static_cast<std::size_t>(m)]);
        x += svd.v.col(k) * product / svd.values[k];
      }
      const SolvedFrame frame = solve_tsvd(a, rank, y);
      CHECK(relative_difference(frame.x, to_float({x.data(), x.data() + 36})) < 1e-6);
      CHECK(frame.info.iterations == 1);
      CHECK(frame.info.health == recon::Health::converged);
      double squared = 0.0;
      const Eigen::VectorXd residual = dense_matrix(a) * x - Eigen::Map<const Eigen::VectorXd>(y.data(), a.rows());
      squared = residual.squaredNorm();
      CHECK(frame.info.objective == doctest::Approx(0.5 * squared).epsilon(1e-5));
    }
  }
}

TEST_CASE("tsvd with weights is the weighted fit within the leading pairs") {
  Random random(20);
  const auto a = random_response(random, 24, Picture{6, 6}, 0.6);
  const auto y = random_vector(random, 24, 0.0, 3.0);
  const auto yf = to_float(y);
  std::vector<float> weights(24, 1.0F);
  weights[2] = weights[9] = weights[23] = 0.0F;
  weights[5] = 0.25F;
  weights[6] = 0.75F;
  const auto svd = recon::reference::singular_pairs(dense_matrix(a));
  for (const int rank : {3, 10, 18}) {
    const Eigen::MatrixXd u = svd.u.leftCols(rank);
    Eigen::VectorXd w(24), b(24);
    for (Eigen::Index m = 0; m < 24; ++m) {
      w[m] = static_cast<double>(weights[static_cast<std::size_t>(m)]);
      b[m] = static_cast<double>(yf[static_cast<std::size_t>(m)]);
    }
    const Eigen::VectorXd d =
        recon::reference::least_squares(u.transpose() * w.asDiagonal() * u, u.transpose() * w.cwiseProduct(b));
    const Eigen::VectorXd x = svd.v.leftCols(rank) * d.cwiseQuotient(svd.values.head(rank));
    CHECK(relative_difference(solve_tsvd(a, rank, y, weights).x, to_float({x.data(), x.data() + 36})) < 1e-4);
  }
}

TEST_CASE("the rank follows lambda where none is given, and impossible ones are refused by name") {
  Random random(21);
  const auto a = random_response(random, 12, Picture{6, 6}, 0.6);
  const Eigen::VectorXd s = recon::reference::singular_pairs(dense_matrix(a)).values;
  const auto by_lambda = recon::singular_modes(a, 0, s[4] * s[4] * 0.999, {});
  REQUIRE(by_lambda.has_value());
  CHECK(by_lambda->values.size() == 5);
  const auto too_many = recon::singular_modes(a, 13, 0.0, {});
  test::check_error(too_many, hal::ErrorCode::out_of_range, "rank", {"13", "12"});
  CHECK_FALSE(recon::singular_modes(a, 0, s[0] * s[0] * 1.01, {}).has_value());
  const auto stopped = recon::singular_modes(a, 3, 0.0, [](std::string_view, double, double) { return false; });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
  recon::Plan plan;
  plan.solver = solver_named("tsvd");
  CHECK(recon::Reconstructor::create(a, {}, plan).error().code == hal::ErrorCode::usage);
}
