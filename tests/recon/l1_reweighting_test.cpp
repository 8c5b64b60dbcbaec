#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::recon;
using namespace compueye::tests;

namespace {

constexpr int signal_length = 120;
constexpr double e = 0.1;

struct SparseProblem {
  Response a;
  std::vector<double> truth;
  std::vector<float> y;
};

SparseProblem sparse_problem(std::uint64_t seed, double sigma) {
  Random random(seed);
  SparseProblem p{
      random_response(random, 40, Picture{1, signal_length}, 0.4), std::vector<double>(signal_length, 0.0), {}};
  for (int dot = 0; dot < 5; ++dot)
    p.truth[static_cast<std::size_t>(random.below(signal_length))] = random.uniform(0.5, 1.0);
  std::vector<double> samples(40);
  p.a.forward(p.truth, samples);
  for (double& s : samples) s += sigma * random.normal();
  p.y = to_float(samples);
  return p;
}

Objective objective_of(double lambda) {
  Objective objective;
  objective.constraint = ConstraintKind::box;
  objective.lambda = lambda;
  return objective;
}

SolvedFrame solved(const SparseProblem& p, const Objective& objective, const Plan& plan) {
  const auto solver = Reconstructor::create(p.a, objective, plan);
  REQUIRE(solver.has_value());
  return solve_frame(*solver, p.y);
}

double squared_error(const SparseProblem& p, const std::vector<float>& x) {
  double sum = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) sum += (x[n] - p.truth[n]) * (x[n] - p.truth[n]);
  return sum;
}

}  // namespace

TEST_CASE("l1 reweighting meets the conditions of a minimum of the weighted objective") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const SparseProblem p = sparse_problem(1, 0.05);
    Plan plan;
    plan.precision = precision;
    plan.iterations = 4000;
    constexpr double lambda = 0.1;
    const SolvedFrame first = solved(p, objective_of(lambda), plan);
    plan.l1_reweighting = e;
    const SolvedFrame second = solved(p, objective_of(lambda), plan);
    std::vector<double> residual(40), slope(signal_length);
    p.a.forward(std::vector<double>(second.x.begin(), second.x.end()), residual);
    double objective = 0.0;
    for (std::size_t m = 0; m < 40; ++m) {
      residual[m] -= p.y[m];
      objective += 0.5 * residual[m] * residual[m];
    }
    p.a.adjoint(residual, slope);
    for (std::size_t n = 0; n < signal_length; ++n) {
      const double weight = lambda * 2.0 * e / (std::abs(first.x[n]) + e);
      objective += weight * second.x[n];
      if (second.x[n] <= 0.0F) CHECK(slope[n] + weight > -2e-3);
      if (second.x[n] >= 1.0F) CHECK(slope[n] + weight < 2e-3);
      if (second.x[n] > 0.0F && second.x[n] < 1.0F) CHECK(std::abs(slope[n] + weight) < 2e-3);
    }
    CHECK(second.info.objective == doctest::Approx(objective).epsilon(1e-4));
    CHECK(second.info.iterations == 2 * plan.iterations);
  }
}

TEST_CASE("l1 reweighting finds a few lit pixels better than one pass does") {
  double once = 0.0, twice = 0.0;
  for (std::uint64_t seed = 2; seed < 22; ++seed) {
    const SparseProblem p = sparse_problem(seed, 0.05);
    Plan plan;
    once += squared_error(p, solved(p, objective_of(0.1), plan).x);
    plan.l1_reweighting = e;
    twice += squared_error(p, solved(p, objective_of(0.1), plan).x);
  }
  CHECK(twice < 0.5 * once);
}

TEST_CASE("l1 reweighting starts every frame afresh, and reports no gap") {
  const SparseProblem p = sparse_problem(30, 0.05), q = sparse_problem(31, 0.05);
  Plan plan;
  plan.l1_reweighting = e;
  plan.measure_gap = true;
  const auto solver = Reconstructor::create(p.a, objective_of(0.1), plan);
  REQUIRE(solver.has_value());
  const recon::AlignedWorkspace workspace(solver->required_bytes());
  std::vector<float> x(signal_length), again(signal_length);
  CHECK(solver->solve(p.y, {}, workspace.span(), x).duality_gap < 0.0);
  static_cast<void>(solver->solve(q.y, {}, workspace.span(), again));
  static_cast<void>(solver->solve(p.y, {}, workspace.span(), again));
  CHECK(x == again);
}

TEST_CASE("l1 reweighting is for admm in pixels, by a brightness") {
  const SparseProblem p = sparse_problem(40, 0.05);
  const auto refused = [&](BasisKind basis, SolverKind kind, double near, hal::ErrorCode code,
                           const test::Named& named) {
    Objective objective = objective_of(0.1);
    objective.basis = basis;
    Plan plan;
    plan.solver = kind;
    plan.l1_reweighting = near;
    test::check_error(Reconstructor::create(p.a, objective, plan), code, "l1 reweighting", named);
  };
  refused(BasisKind::dct, solver_named("admm"), e, hal::ErrorCode::usage, {"admm", "identity"});
  refused(BasisKind::identity, solver_named("fista"), e, hal::ErrorCode::usage, {"admm", "identity"});
  refused(BasisKind::identity, solver_named("admm"), -e, hal::ErrorCode::out_of_range, {"-0.1"});
  refused(BasisKind::identity, solver_named("admm"), std::nan(""), hal::ErrorCode::out_of_range, {"nan"});
}
