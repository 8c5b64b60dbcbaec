#include "recon/setup/factor.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>

#include "recon/core/parts/cholesky.hpp"
#include "recon/core/parts/class_inverse.hpp"
#include "recon/setup/inverse_tables.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::recon;
using namespace compueye::tests;

namespace {

/// A grid of rows that each see a blurred spot, symmetric about both axes.
recon::Response lattice_response(int grid_rows, int grid_cols, int image_rows, int image_cols, double skew) {
  std::vector<double> values;
  for (int i = 0; i < grid_rows; ++i) {
    for (int k = 0; k < grid_cols; ++k) {
      const double cr = (i + 0.5) * image_rows / grid_rows - 0.5 + skew, cc = (k + 0.5) * image_cols / grid_cols - 0.5;
      for (int r = 0; r < image_rows; ++r) {
        for (int c = 0; c < image_cols; ++c) {
          const double d = ((r - cr) * (r - cr) + (c - cc) * (c - cc)) / 6.0;
          values.push_back(d < 4.0 ? std::exp(-d) : 0.0);
        }
      }
    }
  }
  return recon::Response::from_dense(grid_rows * grid_cols, image_rows * image_cols, values)
      .value()
      .with_image(image_rows, image_cols)
      .value();
}

Eigen::MatrixXd direct_inverse(const recon::Response& a, double rho) {
  const Eigen::MatrixXd dense = dense_matrix(a);
  Eigen::MatrixXd gram = dense * dense.transpose();
  gram.diagonal().array() += rho;
  return gram.fullPivLu().inverse();
}

void check_against_direct(const recon::Response& a, double rho) {
  const auto packed = recon::packed_inverse<double>(a, recon::MetricKind::identity, rho, {});
  REQUIRE(packed.has_value());
  const Eigen::MatrixXd expected = direct_inverse(a, rho);
  const recon::ParityClasses classes(a.rows(), recon::find_mirror_symmetry(a));
  CHECK(packed->size() == recon::factor_size(classes));
  recon::KeptTables kept;
  const auto h = recon::make_inverse(classes, {}, packed->data(), kept);
  const auto order = static_cast<std::size_t>(a.rows());
  std::vector<double> scratch(h.scratch_size()), row(order), y(order);
  Random random(45);
  const std::vector<double> x = random_vector(random, a.rows());
  recon::core::multiply(h, x.data(), y.data(), scratch.data());
  const double largest = expected.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < order; ++i) {
    recon::core::expand_row(h, i, row.data(), scratch.data());
    double product = 0.0;
    for (std::size_t j = 0; j < order; ++j) {
      const double entry = expected(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      CHECK(std::abs(row[j] - entry) <= 1e-9 * largest);
      product += entry * x[j];
    }
    CHECK(std::abs(y[i] - product) <= 1e-9 * largest * static_cast<double>(order));
  }
}

}  // namespace

TEST_CASE("the inverse of a symmetric eye, taken class by class, equals the direct one") {
  for (const auto& [gr, gc, ir, ic] :
       {std::tuple{4, 4, 8, 8}, {5, 5, 9, 9}, {4, 5, 8, 11}, {1, 6, 5, 12}, {3, 3, 6, 6}}) {
    const recon::Response a = lattice_response(gr, gc, ir, ic, 0.0);
    CAPTURE(a.rows());
    CAPTURE(a.cols());
    CHECK(recon::find_mirror_symmetry(a).order() == 4);
    check_against_direct(a, 0.05);
  }
}

TEST_CASE("an eye with one mirror axis or none is recognised as such") {
  const recon::Response skewed = lattice_response(4, 6, 9, 12, 0.3);
  CHECK(recon::find_mirror_symmetry(skewed).order() == 2);
  check_against_direct(skewed, 0.02);
  Random random(41);
  const recon::Response any = random_response(random, 23, Picture{5, 8}, 0.5);
  CHECK(recon::find_mirror_symmetry(any).order() == 1);
  check_against_direct(any, 0.1);
}

TEST_CASE("a response that does not know its picture has no symmetry") {
  const auto pixels = Response::from_csr(4, 4, {0, 1, 2, 3, 4}, {0, 1, 2, 3}, {1.0, 1.0, 1.0, 1.0}).value();
  CHECK(find_mirror_symmetry(pixels).order() == 1);
  CHECK(find_diagonal_symmetry(pixels).empty());
  const auto known = pixels.with_image(2, 2).value();
  CHECK(find_mirror_symmetry(known).order() == 4);
  CHECK(find_diagonal_symmetry(known).size() == 4);
}

TEST_CASE("set-up can be interrupted and reports its progress") {
  const recon::Response a = lattice_response(4, 4, 8, 8, 0.0);
  const auto stopped = recon::packed_inverse<float>(a, recon::MetricKind::identity, 0.1,
                                                    [](std::string_view, double, double) { return false; });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
  double last = 0.0;
  const auto made = recon::packed_inverse<float>(a, recon::MetricKind::identity, 0.1,
                                                 [&](std::string_view, double done, double total) {
                                                   CHECK(done <= total);
                                                   last = done / total;
                                                   return true;
                                                 });
  CHECK(made.has_value());
  CHECK(last == 1.0);
}

TEST_CASE("packed symmetric products and rows agree with the whole matrix") {
  Random random(42);
  for (const std::size_t n : {1U, 2U, 17U, 64U}) {
    const auto packed = random_vector(random, static_cast<int>(recon::core::PackedSymmetric<double>::size(n)));
    const recon::core::PackedSymmetric<double> h{n, packed.data()};
    const auto x = random_vector(random, static_cast<int>(n));
    std::vector<double> y(n), row(n);
    recon::core::multiply(h, x.data(), y.data());
    for (std::size_t i = 0; i < n; ++i) {
      recon::core::expand_row(h, i, row.data());
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) {
        sum += row[j] * x[j];
        CHECK(h.at(i, j) == h.at(j, i));
      }
      CHECK(y[i] == doctest::Approx(sum).epsilon(1e-12));
    }
  }
}

TEST_CASE("Cholesky solves, and refuses what is not positive definite") {
  Random random(43);
  const std::size_t n = 30;
  std::vector<double> b = random_vector(random, static_cast<int>(n * n)), a(n * n), x = random_vector(random, 30);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < n; ++k) a[i * n + j] += b[i * n + k] * b[j * n + k];
    }
    a[i * n + i] += 0.1;
  }
  std::vector<double> rhs(n, 0.0), factor = a;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) rhs[i] += a[i * n + j] * x[j];
  }
  REQUIRE(recon::core::cholesky_factor(factor.data(), n));
  recon::core::cholesky_solve(factor.data(), n, rhs.data());
  for (std::size_t i = 0; i < n; ++i) CHECK(rhs[i] == doctest::Approx(x[i]).epsilon(1e-8));
  a[0] = -1.0;
  CHECK_FALSE(recon::core::cholesky_factor(a.data(), n));
  a[0] = std::nan("");
  CHECK_FALSE(recon::core::cholesky_factor(a.data(), n));
}
