#include <doctest/doctest.h>

#include <cmath>

#include "recon/core/bases/dct.hpp"
#include "recon/setup/basis_tables.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

template <class T>
struct Dct {
  Dct(int rows, int cols)
      : row_table(recon::make_dct_table<T>(rows)),
        col_table(recon::make_dct_table<T>(cols)),
        scratch(recon::core::dct_scratch_size(static_cast<std::size_t>(rows), static_cast<std::size_t>(cols))) {
    psi.rows = {static_cast<std::size_t>(rows), row_table.data()};
    psi.cols = {static_cast<std::size_t>(cols), col_table.data()};
  }
  std::vector<T> forward(const std::vector<T>& in) {
    std::vector<T> out(in.size());
    recon::core::dct_forward(psi, in.data(), out.data(), scratch.data());
    return out;
  }
  std::vector<T> inverse(const std::vector<T>& in) {
    std::vector<T> out(in.size());
    recon::core::dct_inverse(psi, in.data(), out.data(), scratch.data());
    return out;
  }
  std::vector<T> row_table, col_table, scratch;
  recon::core::Dct2d<T> psi;
};

double norm(const std::vector<double>& v) {
  double sum = 0.0;
  for (double value : v) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace

TEST_CASE("the 2-D DCT of any size is the definition's") {
  Random random(21);
  for (const auto& [height, width] : {std::pair{1, 1}, {1, 7}, {2, 3}, {5, 5}, {8, 8}, {12, 10}, {16, 16}, {17, 24}}) {
    const int rows = height, cols = width;  // clang 14 captures no structured binding
    CAPTURE(rows);
    CAPTURE(cols);
    const int n = rows * cols;
    const std::vector<double> x = random_vector(random, n);
    Dct<double> dct(rows, cols);
    const std::vector<double> c = dct.forward(x);
    const Eigen::MatrixXd psi = recon::reference::basis_matrix(recon::BasisKind::dct, rows, cols);
    const Eigen::VectorXd expected = psi * Eigen::Map<const Eigen::VectorXd>(x.data(), n);
    for (int k = 0; k < n; ++k) CHECK(std::abs(c[static_cast<std::size_t>(k)] - expected[k]) < 1e-13);
  }
}

TEST_CASE("the 2-D DCT is orthonormal in both precisions at full size") {
  Random random(22);
  for (const auto& [rows, cols] : {std::pair{160, 160}, {96, 161}, {3, 250}}) {
    const std::vector<double> x = random_vector(random, rows * cols);
    Dct<double> exact(rows, cols);
    const std::vector<double> c = exact.forward(x), back = exact.inverse(c);
    CHECK(norm(c) == doctest::Approx(norm(x)).epsilon(1e-12));
    Dct<float> fast(rows, cols);
    const std::vector<float> cf = fast.forward(to_float(x)), backf = fast.inverse(cf);
    double worst = 0.0, worst_float = 0.0, worst_coefficient = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      worst = std::max(worst, std::abs(back[k] - x[k]));
      worst_float = std::max(worst_float, std::abs(static_cast<double>(backf[k]) - x[k]));
      worst_coefficient = std::max(worst_coefficient, std::abs(static_cast<double>(cf[k]) - c[k]));
    }
    CHECK(worst < 1e-12);
    CHECK(worst_float < 2e-5);
    CHECK(worst_coefficient < 2e-5);
  }
}

TEST_CASE("the inverse DCT is the adjoint: dot test, in place too") {
  Random random(23);
  for (const auto& [rows, cols] : {std::pair{6, 10}, {15, 16}, {40, 36}}) {
    const std::vector<double> x = random_vector(random, rows * cols), q = random_vector(random, rows * cols);
    Dct<double> dct(rows, cols);
    const std::vector<double> px = dct.forward(x), ptq = dct.inverse(q);
    double left = 0.0, right = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      left += px[k] * q[k];
      right += x[k] * ptq[k];
    }
    CHECK(left == doctest::Approx(right).epsilon(1e-12));
    std::vector<double> in_place = x;
    recon::core::dct_forward(dct.psi, in_place.data(), in_place.data(), dct.scratch.data());
    CHECK(in_place == px);
  }
}
