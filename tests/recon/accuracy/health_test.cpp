// What a solver says about a frame is never better than what is true, on problems that float32 or the budget lose.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

struct HardProblem {
  std::string why;
  recon::Response a;
  std::vector<float> y;
  double share;  ///< lambda over the least lambda at which the picture is zero
};

/// Dense rows with a floor under them, so that one mode stands far above the rest; row 0 times `first_row`.
HardProblem problem(std::string why, double floor, double first_row, double noise, double share) {
  Random random(91);
  constexpr int rows = 30, side = 8, pixels = side * side;
  std::vector<double> values, truth(pixels, 0.0), y(rows);
  for (int m = 0; m < rows; ++m) {
    for (int n = 0; n < pixels; ++n) values.push_back((m == 0 ? first_row : 1.0) * (floor + random.uniform()));
  }
  for (double& value : truth) value = random.uniform() < 0.15 ? random.uniform() : 0.0;
  HardProblem hard{std::move(why),
                   recon::Response::from_dense(rows, pixels, values).value().with_image(side, side).value(),
                   {},
                   share};
  hard.a.forward(truth, y);
  for (const double value : y) hard.y.push_back(static_cast<float>(value + noise * random.normal()));
  return hard;
}

const std::vector<HardProblem>& hard_problems() {
  static const std::vector<HardProblem> all{
      problem("one row is 1e5 times the others", 0.0, 1e5, 0.01, 1e-6),
      problem("the mean stands 1e4 times above the details", 100.0, 1.0, 0.01, 1e-4),
      problem("lambda is 1e-9 of the largest", 0.0, 1.0, 0.01, 1e-9), problem("an ordinary one", 0.0, 1.0, 0.01, 1e-2)};
  return all;
}

double largest_lambda(const HardProblem& hard) {
  std::vector<double> back(static_cast<std::size_t>(hard.a.cols()));
  hard.a.adjoint(std::vector<double>(hard.y.begin(), hard.y.end()), back);
  double most = 0.0;
  for (const double value : back) most = std::max(most, std::abs(value));
  return most;
}

}  // namespace

TEST_CASE("converged is never said of a frame far from its optimum, nor of one whose gap nobody measured") {
  int said = 0;
  for (const HardProblem& hard : hard_problems()) {
    CAPTURE(hard.why);
    recon::Objective objective;
    objective.lambda = hard.share * largest_lambda(hard);
    objective.constraint = recon::ConstraintKind::nonnegative;
    const auto best =
        recon::reference::solve_reference(hard.a, objective, std::vector<double>(hard.y.begin(), hard.y.end()));
    for (const char* name : {"admm", "adm", "fista", "cp", "pdhg"}) {
      CAPTURE(name);
      for (const bool measured : {false, true}) {
        recon::Plan plan;
        plan.solver = recon::solver_named(name);
        plan.iterations = 300;
        plan.measure_gap = measured;
        const auto solver = recon::Reconstructor::create(hard.a, objective, plan);
        if (!solver) continue;  // refused by name
        const SolvedFrame frame = solve_frame(*solver, hard.y);
        if (frame.info.health != recon::Health::converged) continue;
        ++said;
        const bool always = plan.solver == recon::solver_named("fista") || plan.solver == recon::solver_named("cp");
        CHECK((measured || always));
        const double reached =
            recon::reference::objective_value(hard.a, objective, std::vector<double>(hard.y.begin(), hard.y.end()), {},
                                              std::vector<double>(frame.x.begin(), frame.x.end()));
        CHECK(reached <= best.objective * 1.002);
      }
    }
  }
  CHECK(said > 0);
}

TEST_CASE("direct solvers say converged only of pictures that rounding has not decided") {
  for (const double lambda : {1e-9, 1e-6, 1e-3, 1.0}) {
    for (const char* name : {"tikhonov", "tsvd"}) {
      CAPTURE(name);
      CAPTURE(lambda);
      const double floor = std::string(name) == "tsvd" ? 1e4 : 300.0;
      const HardProblem hard = problem("", floor, 1.0, 0.0, 0.0);
      recon::Objective objective;
      objective.lambda = lambda * hard.a.squared_norm();
      recon::Plan plan;
      plan.solver = recon::solver_named(name);
      if (plan.solver == recon::solver_named("tsvd")) plan.rank = 30;  // every mode
      recon::Plan exact = plan;
      exact.precision = recon::Precision::f64;
      const auto single = recon::Reconstructor::create(hard.a, objective, plan);
      const auto twice = recon::Reconstructor::create(hard.a, objective, exact);
      if (!single || !twice) continue;  // refused by name
      const SolvedFrame frame = solve_frame(*single, hard.y), right = solve_frame(*twice, hard.y);
      CHECK(right.info.health == recon::Health::converged);
      if (frame.info.health != recon::Health::converged) continue;
      if (plan.solver == recon::solver_named("tikhonov")) {
        CHECK(frame.info.objective == doctest::Approx(right.info.objective).epsilon(2e-3));
      } else {
        CHECK(relative_difference(frame.x, right.x) < 2e-3);
      }
    }
  }
}
