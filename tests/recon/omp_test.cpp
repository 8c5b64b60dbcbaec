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
using recon::solver_named;

namespace {

/// The textbook, in dense double: normalised correlations, a full least squares fit an element.
std::vector<double> textbook_omp(const SolverProblem& problem, BasisKind basis, const std::vector<double>& y,
                                 const std::vector<double>& weights, int count) {
  const Eigen::MatrixXd psi = recon::reference::basis_matrix(basis, problem.a.image_rows(), problem.a.image_cols());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(problem.a.rows(), problem.a.cols());
  Eigen::VectorXd b(problem.a.rows());
  for (int m = 0; m < problem.a.rows(); ++m) {
    const double root = std::sqrt(weights[static_cast<std::size_t>(m)]);
    problem.a.for_each_in_row(m, [&](std::int32_t n, double v) { a(m, n) = root * v; });
    b[m] = root * y[static_cast<std::size_t>(m)];
  }
  const Eigen::MatrixXd atoms = a * psi.transpose();
  std::vector<Eigen::Index> taken;
  Eigen::VectorXd amplitudes, residual = b;
  for (int k = 0; k < count; ++k) {
    Eigen::Index best = -1;
    double most = 0.0;
    for (Eigen::Index j = 0; j < atoms.cols(); ++j) {
      const double norm = atoms.col(j).norm();
      if (norm < 1e-12 || std::find(taken.begin(), taken.end(), j) != taken.end()) continue;
      const double share = std::abs(atoms.col(j).dot(residual)) / norm;
      if (share > most) {
        most = share;
        best = j;
      }
    }
    taken.push_back(best);
    Eigen::MatrixXd chosen(atoms.rows(), static_cast<Eigen::Index>(taken.size()));
    for (std::size_t i = 0; i < taken.size(); ++i) chosen.col(static_cast<Eigen::Index>(i)) = atoms.col(taken[i]);
    amplitudes = recon::reference::least_squares(chosen, b);
    residual = b - chosen * amplitudes;
  }
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(atoms.cols());
  for (std::size_t i = 0; i < taken.size(); ++i) coefficients[taken[i]] = amplitudes[static_cast<Eigen::Index>(i)];
  const Eigen::VectorXd x = psi.transpose() * coefficients;
  return {x.data(), x.data() + x.size()};
}

recon::Plan omp_plan(int elements, int channels) {
  recon::Plan plan;
  plan.solver = solver_named("omp");
  plan.iterations = elements;
  plan.max_reweighted = channels;
  return plan;
}

}  // namespace

TEST_CASE("omp takes the textbook's elements and amplitudes, with weights and in every orthonormal basis") {
  Random random(31);
  int compared = 0;
  for (const SolverProblem& problem : solver_problems()) {
    if (problem.name == "duplicated rows" || problem.name == "scaled rows") continue;  // ties decide there
    for (const auto basis : {BasisKind::identity, BasisKind::dct, BasisKind::haar, BasisKind::db4, BasisKind::dft}) {
      for (const bool weighted : {false, true}) {
        CAPTURE(problem.name);
        CAPTURE(static_cast<int>(basis));
        CAPTURE(weighted);
        std::vector<double> y = random_vector(random, problem.a.rows(), 0.0, 2.0);
        std::vector<double> weights(y.size(), 1.0);
        for (std::size_t m = 0; weighted && m < y.size(); m += 4) weights[m] = m % 8 == 0 ? 0.0 : 0.25;
        for (int m = 0; m < problem.a.rows(); ++m) {  // blind rows play no part
          bool sees = false;
          problem.a.for_each_in_row(m, [&](std::int32_t, double v) { sees = sees || v != 0.0; });
          if (!sees) y[static_cast<std::size_t>(m)] = 0.0;
        }
        for (double& v : y) v = static_cast<float>(v);
        recon::Objective objective;
        objective.basis = basis;
        auto plan = omp_plan(4, problem.a.rows());
        plan.precision = recon::Precision::f64;
        const auto solver = recon::Reconstructor::create(problem.a, objective, plan);
        REQUIRE(solver.has_value());
        const SolvedFrame frame = solve_frame(*solver, to_float(y), to_float(weights));
        const auto expected = to_float(textbook_omp(problem, basis, y, weights, 4));
        CHECK(relative_difference(frame.x, expected) < 1e-5);
        CHECK(frame.info.iterations == 4);
        ++compared;
      }
    }
  }
  CHECK(compared == 5 * 2 * count_of_problems({"duplicated rows", "scaled rows"}));
}

TEST_CASE("omp recovers a sparse scene exactly and stops by itself") {
  Random random(32);
  const auto a = random_response(random, 40, Picture{8, 10}, 1.0);
  std::vector<double> truth(80, 0.0), y(40);
  truth[7] = 1.0;
  truth[31] = 0.5;
  truth[66] = 0.8;
  a.forward(truth, y);
  for (const bool by_lambda : {true, false}) {
    recon::Objective objective;
    if (by_lambda) {
      objective.lambda = 1e-3;
    } else {
      objective.epsilon = 1e-3;
    }
    const auto solver = recon::Reconstructor::create(a, objective, omp_plan(20, 0)).value();
    const SolvedFrame frame = solve_frame(solver, to_float(y));
    CHECK(frame.info.health == recon::Health::converged);
    CHECK(frame.info.iterations == 3);
    CHECK(relative_difference(frame.x, to_float(truth)) < 1e-5);
  }
}

TEST_CASE("omp passes over elements that depend on those it has, and stops when none is left") {
  // Two equal columns, one zero column, two rows.
  const auto a = recon::Response::from_dense(2, 4, {1, 1, 0, 0.5, 2, 2, 0, -1}).value().with_image(2, 2).value();
  const auto solver = recon::Reconstructor::create(a, {}, omp_plan(4, 0)).value();
  const SolvedFrame frame = solve_frame(solver, {1.0F, 0.5F});
  CHECK(frame.info.iterations == 2);
  CHECK(frame.info.residual < 1e-5);
  CHECK((frame.x[0] == 0.0F || frame.x[1] == 0.0F));
  CHECK(frame.x[2] == 0.0F);
}
