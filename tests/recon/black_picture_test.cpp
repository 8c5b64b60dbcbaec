// When nothing at all is the best picture, and that it is then handed out to the bit.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

constexpr int rows = 24, black_side = 8, pixels = black_side * black_side;

recon::Response eye() {
  Random random(5);
  return recon::Response::from_dense(rows, pixels, random_vector(random, rows * pixels, 0.0, 1.0))
      .value()
      .with_image(black_side, black_side)
      .value();
}

bool is_black(const SolvedFrame& frame) {
  return std::all_of(frame.x.begin(), frame.x.end(), [](float v) { return v == 0.0F; });
}

SolvedFrame solved(const recon::Response& a, const char* solver, const recon::Objective& objective,
                   const std::vector<double>& y, int iterations) {
  recon::Plan plan;
  plan.solver = recon::solver_named(solver);
  plan.iterations = iterations;
  plan.measure_gap = true;
  return solve_frame(recon::Reconstructor::create(a, objective, plan).value(), to_float(y));
}

double half_square(const std::vector<double>& y) {
  double sum = 0.0;
  for (const double v : y) sum += v * v;
  return 0.5 * sum;
}

}  // namespace

TEST_CASE("beyond the largest lambda the picture is zero to the bit, and proven so") {
  const recon::Response a = eye();
  Random random(6);
  const std::vector<double> y = random_vector(random, rows, 0.0, 2.0);
  std::vector<double> back(pixels);
  a.adjoint(y, back);
  recon::Objective objective;
  const double largest = *std::max_element(back.begin(), back.end());
  for (const char* solver : {"admm", "adm", "cp", "fista", "pdhg"}) {
    CAPTURE(solver);
    objective.lambda = 1.001 * largest;
    const SolvedFrame beyond = solved(a, solver, objective, y, 5);
    CHECK(is_black(beyond));
    CHECK(beyond.info.health == recon::Health::converged);
    CHECK(beyond.info.duality_gap == 0.0);
    CHECK(beyond.info.objective == doctest::Approx(half_square(y)).epsilon(1e-6));
    CHECK(beyond.info.residual == doctest::Approx(std::sqrt(2.0 * half_square(y))).epsilon(1e-6));
    objective.lambda = 0.5 * largest;
    CHECK(!is_black(solved(a, solver, objective, y, 3000)));
  }
}

TEST_CASE("samples below nought leave x >= 0 nothing, whatever lambda and basis") {
  const recon::Response a = eye();
  Random random(7);
  const std::vector<double> y = random_vector(random, rows, -2.0, -1.0);
  for (const auto basis : {recon::BasisKind::identity, recon::BasisKind::dct, recon::BasisKind::tv}) {
    CAPTURE(basis);
    recon::Objective objective;
    objective.basis = basis;
    objective.constraint = recon::ConstraintKind::nonnegative;
    objective.lambda = 0.01;
    for (const char* solver : {"admm", "cp", "pdhg"}) {
      CAPTURE(solver);
      const SolvedFrame frame = solved(a, solver, objective, y, 2);
      CHECK(is_black(frame));
      CHECK(frame.info.health == recon::Health::converged);
      CHECK(frame.info.duality_gap == 0.0);
    }
  }
}

TEST_CASE("no picture is handed out that is worth less than black") {
  const recon::Response a = eye();
  std::vector<double> y(rows, -0.01);
  y[3] = 40.0;  // one channel that no picture explains
  recon::Objective objective;
  objective.constraint = recon::ConstraintKind::nonnegative;
  objective.basis = recon::BasisKind::dct;
  objective.lambda = 20.0;
  for (const char* solver : {"admm", "cp", "pdhg"}) {
    for (const int iterations : {1, 2, 5, 50}) {
      CAPTURE(solver);
      CAPTURE(iterations);
      const SolvedFrame frame = solved(a, solver, objective, y, iterations);
      CHECK(frame.info.objective <= half_square(y) * (1.0 + 1e-6));
      if (frame.info.health != recon::Health::converged) CHECK(frame.info.duality_gap >= 0.0);
    }
  }
}
