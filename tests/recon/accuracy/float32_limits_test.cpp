// Where float32 alone would end above the optimum however long it went on.

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

struct Eye {
  recon::Response a;
  std::vector<double> y;
};

/// Rows of entries in 0..1, the first times `loudness`, that see a picture of a few lit pixels.
Eye dense_eye(int rows, double loudness) {
  Random random(17);
  constexpr int side = 8, pixels = side * side;
  std::vector<double> values, truth(pixels, 0.0), y(static_cast<std::size_t>(rows));
  for (int m = 0; m < rows; ++m) {
    for (int n = 0; n < pixels; ++n) values.push_back((m == 0 ? loudness : 1.0) * random.uniform());
  }
  for (double& value : truth) value = random.uniform() < 0.2 ? random.uniform() : 0.0;
  Eye eye{recon::Response::from_dense(rows, pixels, values).value().with_image(side, side).value(), {}};
  eye.a.forward(truth, y);
  for (const double value : y) eye.y.push_back(static_cast<double>(static_cast<float>(value + 0.01 * random.normal())));
  return eye;
}

recon::Objective objective_of(recon::BasisKind basis, recon::ConstraintKind constraint, double lambda) {
  recon::Objective objective;
  objective.basis = basis;
  objective.constraint = constraint;
  objective.lambda = lambda;
  return objective;
}

struct Answer {
  double above = 0.0;  ///< the best objective, as a share of it
  recon::FrameInfo info;
};

Answer answer(const Eye& eye, const recon::Objective& objective, const char* solver, int iterations,
              const std::vector<double>& weights = {}) {
  recon::Plan plan;
  plan.solver = recon::solver_named(solver);
  plan.iterations = iterations;
  plan.measure_gap = true;
  plan.max_reweighted = eye.a.rows();
  const auto made = recon::Reconstructor::create(eye.a, objective, plan).value();
  const SolvedFrame solved = solve_frame(made, to_float(eye.y), to_float(weights));
  const double best = recon::reference::solve_reference(eye.a, objective, eye.y, weights).objective;
  const std::vector<double> x(solved.x.begin(), solved.x.end());
  return {recon::reference::objective_value(eye.a, objective, eye.y, weights, x) / best - 1.0, solved.info};
}

}  // namespace

TEST_CASE("admm in float32 finds the optimum of a basis and a constraint, and of a lambda a hundred times rho") {
  const Eye eye = dense_eye(150, 1.0);
  for (const auto& [basis, constraint] : {std::pair{recon::BasisKind::dct, recon::ConstraintKind::nonnegative},
                                          std::pair{recon::BasisKind::haar, recon::ConstraintKind::box}}) {
    for (const double lambda : {0.1, 10.0, 200.0}) {
      CAPTURE(lambda);
      const Answer found = answer(eye, objective_of(basis, constraint, lambda), "admm", 20000);
      CHECK(found.above < 1e-4);
      CHECK(found.info.health == recon::Health::converged);
    }
  }
}

TEST_CASE("a row 1e5 times as loud as the others does not decide how fast they are solved") {
  const Eye eye = dense_eye(24, 1e5);
  const auto in_pixels = objective_of(recon::BasisKind::identity, recon::ConstraintKind::box, 0.3);
  CHECK(answer(eye, in_pixels, "admm", 1000).above < 0.01);
  CHECK(answer(eye, in_pixels, "adm", 1000).above < 0.01);
  const auto in_dct = objective_of(recon::BasisKind::dct, recon::ConstraintKind::box, 0.3);
  CHECK(answer(eye, in_dct, "admm", 10000).above < 0.03);
  const Answer pdhg = answer(eye, in_pixels, "pdhg", 3000);
  CHECK(pdhg.info.health == recon::Health::budget_used);
  CHECK(pdhg.info.duality_gap >= pdhg.info.objective * pdhg.above / (1.0 + pdhg.above) * 0.99);
}

TEST_CASE("a rho beyond a loud row needs no scaling, and its inverse is kept in float32") {
  const Eye eye = dense_eye(24, 1e5);
  recon::Plan plan;
  plan.solver = recon::solver_named("tikhonov");
  for (const double share : {1e-6, 1e-3, 1.0, 1e3}) {
    CAPTURE(share);
    const auto objective =
        objective_of(recon::BasisKind::identity, recon::ConstraintKind::none, share * eye.a.squared_norm());
    const auto made = recon::Reconstructor::create(eye.a, objective, plan);
    REQUIRE(made);
    CHECK(solve_frame(*made, to_float(eye.y)).info.health == recon::Health::converged);
  }
}

TEST_CASE("weights across nine decades are solved in float32") {
  const Eye eye = dense_eye(24, 1.0);
  std::vector<double> weights;
  for (int m = 0; m < 24; ++m) weights.push_back(static_cast<double>(static_cast<float>(std::pow(1e-9, m / 23.0))));
  const auto objective = objective_of(recon::BasisKind::identity, recon::ConstraintKind::none, 3.5e-4);
  for (const char* solver : {"adm", "admm"}) {
    CAPTURE(solver);
    const Answer found = answer(eye, objective, solver, 5000, weights);
    CHECK(found.info.health != recon::Health::invalid);
    CHECK(found.above < 0.03);
  }
}

TEST_CASE("tikhonov in float32 refines what its rounded inverse leaves") {
  const Eye eye = dense_eye(24, 1.0);
  recon::Plan plan;
  plan.solver = recon::solver_named("tikhonov");
  const auto objective =
      objective_of(recon::BasisKind::identity, recon::ConstraintKind::none, 1e-6 * eye.a.squared_norm());
  plan.precision = recon::Precision::f64;
  const auto exact = recon::Reconstructor::create(eye.a, objective, plan).value();
  plan.precision = recon::Precision::f32;
  const auto single = recon::Reconstructor::create(eye.a, objective, plan).value();
  const SolvedFrame best = solve_frame(exact, to_float(eye.y)), found = solve_frame(single, to_float(eye.y));
  CHECK(found.info.health == recon::Health::converged);
  CHECK(found.info.objective < best.info.objective * 1.001);
}
