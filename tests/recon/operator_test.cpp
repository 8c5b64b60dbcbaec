#include "recon/core/operators/linear_operator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "recon/core/parts/vector_sums.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

/// A response's float tables as the operator wants them, dense or sparse.
struct Tables {
  std::vector<float> values;
  std::vector<std::uint32_t> row_start{0};
  std::vector<std::int32_t> columns;

  recon::core::LinearOperator<float> fill(const recon::Response& a, recon::OperatorKind kind) {
    const auto cols = static_cast<std::size_t>(a.cols());
    if (kind == recon::OperatorKind::dense) values.assign(static_cast<std::size_t>(a.rows()) * cols, 0.0F);
    for (int m = 0; m < a.rows(); ++m) {
      a.for_each_in_row(m, [&](std::int32_t n, double v) {
        if (kind == recon::OperatorKind::dense) {
          values[static_cast<std::size_t>(m) * cols + static_cast<std::size_t>(n)] = static_cast<float>(v);
        } else {
          values.push_back(static_cast<float>(v));
          columns.push_back(n);
        }
      });
      row_start.push_back(static_cast<std::uint32_t>(values.size()));
    }
    return {kind, static_cast<std::size_t>(a.rows()), cols, values.data(), row_start.data(), columns.data(), {}};
  }
};

}  // namespace

TEST_CASE("operators agree with dense double within the bound of their sums") {
  Random random(11);
  for (const auto kind : {recon::OperatorKind::dense, recon::OperatorKind::csr}) {
    for (const auto& [rows, cols, density] : {std::tuple{1, 1, 1.0}, {7, 33, 1.0}, {40, 97, 0.3}, {65, 16, 0.05}}) {
      const recon::Response a = random_response(random, rows, cols, density);
      Tables tables;
      const auto op = tables.fill(a, kind);
      const auto x = to_float(random_vector(random, cols));
      std::vector<float> y(static_cast<std::size_t>(rows));
      recon::core::forward(op, x.data(), y.data(), nullptr);
      for (int m = 0; m < rows; ++m) {
        double exact = 0.0, magnitude = 0.0;
        int terms = 0;
        a.for_each_in_row(m, [&](std::int32_t n, double v) {
          exact += v * static_cast<double>(x[static_cast<std::size_t>(n)]);
          magnitude += std::abs(v * static_cast<double>(x[static_cast<std::size_t>(n)]));
          ++terms;
        });
        // Higham, "Accuracy and Stability", eq. 3.5: n/16 additions a lane, 4 in the tree, one rounding of each entry.
        const double bound = (terms / 16.0 + 8.0) * 6e-8 * magnitude;
        CHECK(std::abs(static_cast<double>(y[static_cast<std::size_t>(m)]) - exact) <= bound + 1e-30);
      }
    }
  }
}

TEST_CASE("adjoints pass the dot test and accumulate") {
  Random random(12);
  for (const auto kind : {recon::OperatorKind::dense, recon::OperatorKind::csr}) {
    for (int trial = 0; trial < 20; ++trial) {
      const int rows = 1 + random.below(70), cols = 1 + random.below(90);
      const recon::Response a = random_response(random, rows, cols, 0.4);
      Tables tables;
      const auto op = tables.fill(a, kind);
      const auto x = to_float(random_vector(random, cols)), u = to_float(random_vector(random, rows));
      std::vector<float> ax(u.size()), atu(x.size(), 0.0F);
      recon::core::forward(op, x.data(), ax.data(), nullptr);
      recon::core::adjoint_accumulate(op, u.data(), atu.data(), nullptr);
      double left = 0.0, right = 0.0, size = 1e-30;
      for (std::size_t m = 0; m < u.size(); ++m) left += static_cast<double>(ax[m]) * static_cast<double>(u[m]);
      for (std::size_t n = 0; n < x.size(); ++n) {
        right += static_cast<double>(atu[n]) * static_cast<double>(x[n]);
        size += std::abs(static_cast<double>(atu[n]) * static_cast<double>(x[n]));
      }
      CHECK(std::abs(left - right) <= 2e-6 * (size + rows));
      std::vector<float> twice = atu;
      recon::core::adjoint_accumulate(op, u.data(), twice.data(), nullptr);
      for (std::size_t n = 0; n < x.size(); ++n) {
        CHECK(twice[n] == doctest::Approx(2.0F * atu[n]).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("finite check sees every NaN and infinity") {
  for (std::size_t n : {1U, 15U, 16U, 17U, 100U}) {
    std::vector<float> a(n, 3.0e38F);
    CHECK(recon::core::all_finite(a.data(), n));
    for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
      for (std::size_t k = 0; k < n; ++k) {
        std::vector<float> b = a;
        b[k] = bad;
        CHECK_FALSE(recon::core::all_finite(b.data(), n));
      }
    }
  }
}
