#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "recon/solver_list.hpp"
#include "tests/recon/reference/dense_algebra.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/recon/solver_problems.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::BasisKind;
using recon::ConstraintKind;
using recon::solver_named;

namespace {

struct Bounded {
  std::vector<double> y, weights;
  double epsilon = 0.0;
  double least = 0.0;  ///< ||Psi x||_1 at the solution
};

double magnitudes(const SolverProblem& problem, BasisKind basis, const std::vector<double>& x) {
  const Eigen::MatrixXd psi = recon::reference::basis_matrix(basis, problem.a.image_rows(), problem.a.image_cols());
  return (psi * Eigen::Map<const Eigen::VectorXd>(x.data(), psi.cols())).cwiseAbs().sum();
}

double residual_of(const SolverProblem& problem, const Bounded& b, const std::vector<double>& x) {
  std::vector<double> ax(b.y.size());
  problem.a.forward(x, ax);
  double sum = 0.0;
  for (std::size_t m = 0; m < ax.size(); ++m) {
    if (b.weights[m] > 0.0) sum += b.weights[m] * (ax[m] - b.y[m]) * (ax[m] - b.y[m]);
  }
  return std::sqrt(sum);
}

/// By duality the minimiser x of the penalised problem also minimises ||Psi x||_1 subject to
/// ||W^(1/2)(A x - y)|| <= epsilon, for epsilon its own residual: one interior point serves both.
Bounded bounded_problem(const SolverProblem& problem, recon::Objective objective, Random& random, bool weighted) {
  Bounded b;
  std::vector<double> truth(static_cast<std::size_t>(problem.a.cols()), 0.0);
  for (double& v : truth) v = random.uniform() < 0.3 ? random.uniform(0.2, 1.0) : 0.0;
  b.y.resize(static_cast<std::size_t>(problem.a.rows()));
  b.weights.assign(b.y.size(), 1.0);
  problem.a.forward(truth, b.y);
  for (double& v : b.y) v = v == 0.0 ? 0.0 : static_cast<float>(v + 0.05 * random.normal());
  for (std::size_t m = 0; weighted && m < b.y.size(); m += 4) b.weights[m] = m % 8 == 0 ? 0.0 : 0.3F;
  const auto best = recon::reference::solve_reference(problem.a, objective, b.y, b.weights);
  REQUIRE(best.converged);
  b.epsilon = residual_of(problem, b, best.x);
  b.least = magnitudes(problem, objective.basis, best.x);
  return b;
}

}  // namespace

TEST_CASE("adm with epsilon: the bound holds and the l1 norm is the least, for rows far from orthonormal") {
  Random random(41);
  int compared = 0;
  for (const SolverProblem& problem : solver_problems()) {
    for (const auto& each : {std::pair{BasisKind::identity, ConstraintKind::none},
                             {BasisKind::identity, ConstraintKind::nonnegative},
                             {BasisKind::identity, ConstraintKind::box},
                             {BasisKind::dct, ConstraintKind::none},
                             {BasisKind::haar, ConstraintKind::none},
                             {BasisKind::dft, ConstraintKind::none}}) {
      for (const bool weighted : {false, true}) {
        CAPTURE(problem.name);
        CAPTURE(static_cast<int>(each.first));
        CAPTURE(static_cast<int>(each.second));
        CAPTURE(weighted);
        recon::Objective objective;
        objective.basis = each.first;
        objective.constraint = each.second;
        objective.lambda = 0.1;
        const Bounded b = bounded_problem(problem, objective, random, weighted);
        objective.epsilon = b.epsilon;
        recon::Plan plan;
        plan.solver = solver_named("adm");
        plan.iterations = 5000;
        plan.max_reweighted = problem.a.rows();
        plan.measure_gap = true;
        const auto solver = recon::Reconstructor::create(problem.a, objective, plan);
        REQUIRE(solver.has_value());
        const SolvedFrame frame = solve_frame(*solver, to_float(b.y), to_float(b.weights));
        const std::vector<double> x(frame.x.begin(), frame.x.end());
        ++compared;
        const bool proven = frame.info.duality_gap <= 1e-3 * frame.info.objective;  // negative with a box: has none
        CHECK((frame.info.health == recon::Health::converged) == proven);
        CHECK(residual_of(problem, b, x) <= b.epsilon * (1.0 + 1e-3));
        CHECK(magnitudes(problem, each.first, x) == doctest::Approx(b.least).epsilon(1e-3));
        CHECK(frame.info.objective == doctest::Approx(magnitudes(problem, each.first, x)).epsilon(1e-5));
        CHECK(frame.info.residual == doctest::Approx(b.epsilon).epsilon(1e-3));
        if (each.second == ConstraintKind::box) continue;
        CHECK(frame.info.duality_gap >= 0.0);
        CHECK(frame.info.duality_gap <= 1e-2 * b.least);
      }
    }
  }
  CHECK(compared == 6 * 2 * count_of_problems());
}

TEST_CASE("adm as published never looks at epsilon in a step: its residual has nothing to do with it") {
  Random random(42);
  const SolverProblem problem = solver_problems().front();
  recon::Objective objective;
  objective.lambda = 0.1;
  const Bounded b = bounded_problem(problem, objective, random, false);
  recon::Plan plan;
  plan.solver = solver_named("adm as published");
  plan.iterations = 20000;
  std::vector<float> last;
  for (const double share : {0.5, 1.0, 1.5}) {
    objective.epsilon = share * b.epsilon;
    const auto solver = recon::Reconstructor::create(problem.a, objective, plan).value();
    const SolvedFrame frame = solve_frame(solver, to_float(b.y));
    CHECK(std::abs(frame.info.residual - *objective.epsilon) > 0.2 * *objective.epsilon);
    if (!last.empty()) CHECK(relative_difference(frame.x, last) < 1e-2);
    last = frame.x;
    plan.solver = solver_named("adm");
    const auto right = recon::Reconstructor::create(problem.a, objective, plan).value();
    CHECK(solve_frame(right, to_float(b.y)).info.residual == doctest::Approx(*objective.epsilon).epsilon(1e-3));
    plan.solver = solver_named("adm as published");
  }
}

TEST_CASE("adm as published is right where it was meant to be: on orthonormal rows") {
  Random random(43);
  Eigen::MatrixXd raw(20, 48);
  for (Eigen::Index k = 0; k < raw.size(); ++k) raw.data()[k] = random.normal();
  const Eigen::MatrixXd q = recon::reference::singular_pairs(raw.transpose()).u;
  std::vector<double> values(q.data(), q.data() + q.size());  // column-major 48 x 20 is row-major 20 x 48
  const auto a = recon::Response::from_dense(20, 48, values).value().with_image(6, 8).value();
  std::vector<double> truth(48, 0.0), y(20);
  truth[5] = 1.0;
  truth[30] = -0.6;
  a.forward(truth, y);
  recon::Objective objective;
  objective.lambda = 0.01;
  const auto best = recon::reference::solve_reference(a, objective, std::vector<double>(y.begin(), y.end()));
  recon::Plan plan;
  plan.solver = solver_named("adm as published");
  plan.precision = recon::Precision::f64;
  plan.iterations = 2000;
  const SolvedFrame frame = solve_frame(recon::Reconstructor::create(a, objective, plan).value(), to_float(y));
  CHECK(frame.info.health == recon::Health::converged);
  CHECK(frame.info.iterations < 1000);
  CHECK(frame.info.objective == doctest::Approx(best.objective).epsilon(1e-3));
}
