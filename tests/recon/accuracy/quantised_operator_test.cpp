#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "recon/option_names.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/recon/solver_problems.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::BasisKind;
using recon::OperatorKind;
using recon::solver_named;
using recon::SolverKind;

namespace {

/// Solves with a lossy operator; what it reaches is judged by the matrix that is applied.
void check_solver(const SolverProblem& problem, const recon::Response& applied, OperatorKind kind, SolverKind solver,
                  BasisKind basis, const std::vector<double>& y) {
  recon::Objective objective;
  objective.basis = basis;
  objective.constraint = recon::ConstraintKind::none;
  objective.lambda = 0.1;
  const std::vector<double> ones(y.size(), 1.0);
  const auto best = recon::reference::solve_reference(applied, objective, y, ones);
  REQUIRE(best.converged);
  recon::Plan plan;
  plan.solver = solver;
  plan.iterations = 5000;
  plan.op = kind;
  const auto made = recon::Reconstructor::create(problem.a, objective, plan);
  REQUIRE(made.has_value());
  CHECK(made->operating_point().op == kind);
  const SolvedFrame frame = solve_frame(*made, to_float(y));
  const double reached = recon::reference::objective_value(applied, objective, y, ones,
                                                           std::vector<double>(frame.x.begin(), frame.x.end()));
  CHECK(reached <= best.objective * (1.0 + 1e-4) + 1e-7);
  CHECK(frame.info.objective == doctest::Approx(reached).epsilon(1e-4));
}

}  // namespace

TEST_CASE("solvers with a rounded operator solve the problem of the rounded matrix") {
  Random random(91);
  int solved = 0;
  for (const SolverProblem& problem : solver_problems()) {
    if (problem.name == "scaled rows") continue;  // takes first-order methods 100,000 iterations
    CAPTURE(problem.name);
    std::vector<double> truth(static_cast<std::size_t>(problem.a.cols())),
        y(static_cast<std::size_t>(problem.a.rows()));
    for (double& v : truth) v = random.uniform() < 0.3 ? random.uniform(0.2, 1.0) : 0.0;
    problem.a.forward(truth, y);
    for (double& v : y) v = v == 0.0 ? 0.0 : static_cast<float>(v + 0.05 * random.normal());
    for (const OperatorKind kind : {OperatorKind::dense_runs_bf16, OperatorKind::dense_runs_int8}) {
      CAPTURE(recon::name(kind));
      const recon::Response applied = recon::quantised(problem.a, kind);
      for (const BasisKind basis : {BasisKind::identity, BasisKind::dct, BasisKind::tv}) {
        CAPTURE(recon::name(basis));
        for (const SolverKind solver :
             {solver_named("admm"), solver_named("adm"), solver_named("fista"), solver_named("cp")}) {
          if (!recon::supports(solver, basis, recon::ConstraintKind::none)) continue;
          CAPTURE(recon::name(solver));
          check_solver(problem, applied, kind, solver, basis, y);
          ++solved;
        }
      }
    }
  }
  CHECK(solved == count_of_problems({"scaled rows"}) * 2 * (4 + 4 + 2));
}

TEST_CASE("the factor of a rounded operator is that of the rounded matrix") {
  const recon::Response a = measured_eye(2);
  recon::Objective objective;
  objective.lambda = 0.1;
  recon::Plan plan;
  plan.rho = 0.5;
  plan.op = OperatorKind::dense_runs_int8;
  const auto made = recon::Reconstructor::create(a, objective, plan).value();
  const auto again =
      recon::Reconstructor::create(recon::quantised(a, OperatorKind::dense_runs_int8), objective, plan).value();
  CHECK(made.factor().values == again.factor().values);
  plan.op = OperatorKind::dense_runs;
  CHECK(recon::Reconstructor::create(a, objective, plan).value().factor().values != made.factor().values);
}
