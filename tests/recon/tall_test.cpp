// Many more rows than pixels: what is made on the pixels' side.

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <cmath>

#include "recon/setup/leading_modes.hpp"
#include "recon/setup/shorter_side.hpp"
#include "recon/setup/singular_modes.hpp"
#include "recon/setup/tall_response.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/dense_algebra.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

Eigen::MatrixXd orthonormal(Random& random, int rows, int cols) {
  const auto values = random_vector(random, rows * cols);
  const Eigen::Map<const Eigen::MatrixXd> matrix(values.data(), rows, cols);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  return qr.householderQ() * Eigen::MatrixXd::Identity(rows, cols);
}

/// Singular values from 1 to 1 / condition, the same factor apart.
recon::Response tall_of_condition(int rows, const Picture& picture, double condition) {
  Random random(7);
  const int cols = picture.rows * picture.cols;
  Eigen::VectorXd values(cols);
  for (int k = 0; k < cols; ++k) values[k] = std::pow(condition, -static_cast<double>(k) / (cols - 1));
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> a =
      orthonormal(random, rows, cols) * values.asDiagonal() * orthonormal(random, cols, cols).transpose();
  return recon::Response::from_dense(rows, cols, {a.data(), a.data() + a.size()})
      .value()
      .with_image(picture.rows, picture.cols)
      .value();
}

}  // namespace

TEST_CASE("singular pairs of a tall response have the digits of a decomposition that squares nothing") {
  for (const double condition : {1e3, 9e5}) {
    CAPTURE(condition);
    const recon::Response a = tall_of_condition(150, Picture{4, 5}, condition);
    const auto svd = recon::reference::singular_pairs(dense_matrix(a));
    const auto modes = recon::singular_modes(a, 20, 0.0, {});
    REQUIRE(modes.has_value());
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> left(
        modes->left.data(), a.rows(), 20);
    for (int k = 0; k < 20; ++k) {
      const double value = modes->values[static_cast<std::size_t>(k)];
      CHECK(std::abs(value - svd.values[k]) <= 1e-8 * svd.values[k]);
    }
    CHECK((left.transpose() * left - Eigen::MatrixXd::Identity(20, 20)).cwiseAbs().maxCoeff() < 1e-8);
  }
}

TEST_CASE("the triangle of a tall response is that of all its blocks, and can be given up") {
  Random random(8);
  for (const int rows : {24, 96, 131}) {  // one block of 48 rows or less, whole ones, and a last one of a few rows
    CAPTURE(rows);
    const recon::Response a = random_response(random, rows, Picture{3, 4}, 0.7);
    REQUIRE(recon::is_tall(a));
    const Eigen::MatrixXd dense = dense_matrix(a), r = recon::triangle(a, {}).value();
    CHECK(r.isUpperTriangular());
    CHECK((r.transpose() * r - dense.transpose() * dense).cwiseAbs().maxCoeff() < 1e-12 * a.squared_norm());
  }
  const recon::Response a = random_response(random, 96, Picture{3, 4}, 0.7);
  const auto stopped = recon::triangle(a, [](std::string_view, double, double) { return false; });
  test::check_error(stopped, hal::ErrorCode::interrupted, "set-up", {});
}

TEST_CASE("modes of a tall response are orthonormal, and nought where its pixels say the same") {
  Random random(9);
  const recon::Response sound = random_response(random, 90, Picture{4, 5}, 0.6);
  Eigen::MatrixXd repeated = dense_matrix(sound);
  repeated.col(7) = repeated.col(3);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = repeated;
  const recon::Response a =
      recon::Response::from_dense(90, 20, {rows.data(), rows.data() + rows.size()}).value().with_image(4, 5).value();
  const recon::ParityClasses classes = recon::mode_classes(a);
  const auto modes = recon::leading_modes(a, 20, {}).value();
  REQUIRE(modes.size() == recon::modes_size(classes, 20));
  const auto svd = recon::reference::singular_pairs(repeated);
  const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> left(modes.data() + 21,
                                                                                                     90, 20);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Identity(20, 20);
  expected(19, 19) = 0.0;
  CHECK((left.cast<double>().transpose() * left.cast<double>() - expected).cwiseAbs().maxCoeff() < 1e-5);
  for (std::size_t k = 0; k < 19; ++k) {
    const double square = svd.values[static_cast<Eigen::Index>(k)] * svd.values[static_cast<Eigen::Index>(k)];
    CHECK(std::abs(static_cast<double>(modes[k]) - square) <= 1e-6 * square);
  }
  CHECK(modes[20] < 1e-12F * modes[0]);  // bounds what is left out
}

TEST_CASE("missing channels of a tall response, more than it has pixels, are as if their rows were not there") {
  Random random(10);
  const recon::Response a = random_response(random, 240, Picture{4, 5}, 0.6);
  const auto y = to_float(random_vector(random, 240, 0.0, 3.0));
  std::vector<float> weights(240, 1.0F), left;
  std::vector<std::int32_t> rows;
  for (std::int32_t m = 0; m < 240; ++m) {
    const auto at = static_cast<std::size_t>(m);
    weights[at] = m % 3 == 0 ? 0.0F : 1.0F;
    if (m % 3 != 0) rows.push_back(m);
    if (m % 3 != 0) left.push_back(y[at]);
  }
  for (const std::string_view solver : {"admm", "adm", "tikhonov", "tsvd", "pdhg"}) {
    CAPTURE(solver);
    recon::Objective objective;
    objective.lambda = 0.5;
    recon::Plan plan;
    plan.solver = recon::solver_named(solver);
    plan.precision = recon::Precision::f64;
    plan.iterations = 3000;
    plan.rank = solver == "tsvd" ? 20 : 0;
    plan.max_reweighted = 100;
    const auto whole = recon::Reconstructor::create(a, objective, plan).value();
    const auto without = recon::Reconstructor::create(a.select_rows(rows), objective, plan).value();
    const SolvedFrame missing = solve_frame(whole, y, weights), expected = solve_frame(without, left);
    CHECK(missing.info.channels_reweighted == 80);
    CHECK(relative_difference(missing.x, expected.x) < 1e-5);
  }
}
