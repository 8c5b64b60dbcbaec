#include "tests/recon/reference/reference_solver.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;

TEST_CASE("the reference satisfies the optimality conditions of the lasso") {
  Random random(61);
  const recon::Response a = random_response(random, 12, Picture{4, 5}, 0.5);
  const auto y = random_vector(random, 12, 0, 2);
  recon::Objective objective;
  objective.lambda = 0.3;
  const auto result = recon::reference::solve_reference(a, objective, y);
  REQUIRE(result.converged);
  std::vector<double> residual(12), gradient(20);
  a.forward(result.x, residual);
  for (std::size_t m = 0; m < 12; ++m) residual[m] -= y[m];
  a.adjoint(residual, gradient);
  for (std::size_t n = 0; n < 20; ++n) {
    if (std::abs(result.x[n]) > 1e-6) {
      CHECK(gradient[n] == doctest::Approx(result.x[n] > 0 ? -0.3 : 0.3).epsilon(1e-6));
    } else {
      CHECK(std::abs(gradient[n]) <= 0.3 + 1e-7);
    }
  }
}

TEST_CASE("the reference cannot be improved by feasible random moves, box and DCT") {
  Random random(62);
  const recon::Response a = random_response(random, 10, Picture{4, 4}, 0.6);
  const auto y = random_vector(random, 10, 0, 3);
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 0.2;
  const auto best = recon::reference::solve_reference(a, objective, y);
  REQUIRE(best.converged);
  for (const double v : best.x) {
    CHECK(v >= -1e-9);
    CHECK(v <= 1.0 + 1e-9);
  }
  for (int trial = 0; trial < 2000; ++trial) {
    auto moved = best.x;
    const double size = std::pow(10.0, random.uniform(-6, 0));
    for (double& v : moved) v = std::clamp(v + size * random.normal(), 0.0, 1.0);
    CHECK(recon::reference::objective_value(a, objective, y, {}, moved) >= best.objective * (1.0 - 1e-9));
  }
}
