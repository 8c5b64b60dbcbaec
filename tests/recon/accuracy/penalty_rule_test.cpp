#include "recon/setup/penalty_rule.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::recon;
using namespace compueye::tests;

namespace {

Objective objective_of(BasisKind basis, double lambda = 0.1) {
  Objective objective;
  objective.basis = basis;
  objective.constraint = ConstraintKind::box;
  objective.lambda = lambda;
  return objective;
}

/// ||A||_F^2 and ||A D'||_F^2 straight from their definitions.
struct Norms {
  double squares = 0.0, differences = 0.0;
};

Norms norms_of(const Response& a, int rows, int cols) {
  Norms norms;
  for (int m = 0; m < a.rows(); ++m) {
    std::vector<double> p(static_cast<std::size_t>(a.cols()), 0.0);
    a.for_each_in_row(m, [&](std::int32_t n, double v) { p[static_cast<std::size_t>(n)] = v; });
    const auto at = [&](int r, int c) { return p[static_cast<std::size_t>(r * cols + c)]; };
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < cols; ++c) {
        norms.squares += at(r, c) * at(r, c);
        if (r + 1 < rows) norms.differences += (at(r + 1, c) - at(r, c)) * (at(r + 1, c) - at(r, c));
        if (c + 1 < cols) norms.differences += (at(r, c + 1) - at(r, c)) * (at(r, c + 1) - at(r, c));
      }
    }
  }
  return norms;
}

/// Fields of 7x7 ones, one a pixel of every other row and column.
Response wide_fields(int side) {
  std::vector<double> values;
  int rows = 0;
  for (int i = 1; i < side; i += 2) {
    for (int k = 1; k < side; k += 2, ++rows) {
      for (int r = 0; r < side; ++r) {
        for (int c = 0; c < side; ++c) values.push_back(std::abs(r - i) <= 3 && std::abs(c - k) <= 3 ? 1.0 : 0.0);
      }
    }
  }
  return Response::from_dense(rows, side * side, values).value().with_image(side, side).value();
}

}  // namespace

TEST_CASE("rho by rule comes from A's norms, over columns or over differences") {
  Random random(1);
  for (const double density : {0.2, 1.0}) {
    const Response a = random_response(random, 20, Picture{8, 6}, density);
    const Norms norms = norms_of(a, 8, 6);
    for (const BasisKind basis : {BasisKind::identity, BasisKind::dct, BasisKind::haar}) {
      CHECK(resolve_rho(a, objective_of(basis), {}) == doctest::Approx(0.06 * norms.squares / 48.0));
    }
    CHECK(resolve_rho(a, objective_of(BasisKind::tv), {}) ==
          doctest::Approx(0.1 * std::sqrt(norms.squares * norms.differences) / 48.0));
  }
}

TEST_CASE("rho by rule knows neither lambda nor the stored form, and scales as A squared") {
  const Response dense = wide_fields(12);
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < dense.rows(); ++m) {
    dense.for_each_in_row(m, [&](std::int32_t n, double v) {
      if (v == 0.0) return;
      columns.push_back(n);
      values.push_back(3.0 * v);
    });
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  const Response tripled =
      Response::from_csr(dense.rows(), dense.cols(), start, columns, values).value().with_image(12, 12).value();
  for (const BasisKind basis : {BasisKind::dct, BasisKind::tv}) {
    const double rho = resolve_rho(dense, objective_of(basis, 0.1), {});
    CHECK(resolve_rho(dense, objective_of(basis, 10.0), {}) == rho);
    CHECK(resolve_rho(tripled, objective_of(basis), {}) == doctest::Approx(9.0 * rho));
  }
  Plan given;
  given.rho = 0.7;
  CHECK(resolve_rho(dense, objective_of(BasisKind::tv), given) == 0.7);
}

TEST_CASE("fields without an edge still have a rho") {
  const Response even = Response::from_dense(2, 16, std::vector<double>(32, 1.0)).value().with_image(4, 4).value();
  CHECK(resolve_rho(even, objective_of(BasisKind::tv), {}) == doctest::Approx(0.06 * 2.0));
}

TEST_CASE("with rho by rule total variation comes within a percent of its converged objective in 150 iterations") {
  constexpr int side = 24;
  const Response a = wide_fields(side);
  Random random(2);
  std::vector<double> truth(side * side, 0.0), signal(static_cast<std::size_t>(a.rows()));
  for (int r = 6; r < 18; ++r) {
    for (int c = 9; c < 20; ++c) truth[static_cast<std::size_t>(r * side + c)] = 0.8;
  }
  a.forward(truth, signal);
  std::vector<float> y;
  for (const double s : signal) y.push_back(static_cast<float>(s + 0.3 * random.normal()));
  const auto objective_after = [&](double rho, int iterations) {
    Plan plan;
    plan.rho = rho;
    plan.iterations = iterations;
    const auto solver = Reconstructor::create(a, objective_of(BasisKind::tv), plan);
    REQUIRE(solver.has_value());
    return solve_frame(*solver, y).info.objective;
  };
  const double rho = resolve_rho(a, objective_of(BasisKind::tv), {});
  const double converged = objective_after(rho, 3000);
  CHECK(objective_after(rho, 150) < 1.01 * converged);
  for (const double factor : {0.03, 100.0}) {
    CAPTURE(factor);
    CHECK(objective_after(factor * rho, 60) > 1.02 * objective_after(rho, 60));
  }
}
