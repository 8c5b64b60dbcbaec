#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "recon/option_names.hpp"
#include "recon/reference/reference_solver.hpp"
#include "recon/solver_table.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::BasisKind;
using recon::ConstraintKind;
using recon::Response;
using recon::SolverKind;

namespace {

struct Problem {
  std::string name;
  Response a;
  int rows, cols;
};

Response with_rows(const Response& a, const std::vector<std::int32_t>& order, const std::vector<double>& scale) {
  std::vector<double> values;
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::vector<double> row(static_cast<std::size_t>(a.cols()), 0.0);
    if (order[i] >= 0) {
      a.for_each_in_row(order[i], [&](std::int32_t n, double v) { row[static_cast<std::size_t>(n)] = v * scale[i]; });
    }
    values.insert(values.end(), row.begin(), row.end());
  }
  return Response::from_dense(static_cast<int>(order.size()), a.cols(), values).value();
}

Response without_columns(const Response& a, int every) {
  std::vector<double> values(static_cast<std::size_t>(a.rows()) * static_cast<std::size_t>(a.cols()), 0.0);
  for (int m = 0; m < a.rows(); ++m) {
    a.for_each_in_row(m, [&](std::int32_t n, double v) {
      if (n % every != 0)
        values[static_cast<std::size_t>(m) * static_cast<std::size_t>(a.cols()) + static_cast<std::size_t>(n)] = v;
    });
  }
  return Response::from_dense(a.rows(), a.cols(), values).value();
}

/// Dense, sparse, wide, tall, duplicated rows, zero rows, zero columns, badly scaled rows, nearly parallel rows.
std::vector<Problem> problems() {
  Random random(71);
  std::vector<Problem> all;
  all.push_back({"dense wide", random_response(random, 12, 36, 1.0), 6, 6});
  all.push_back({"sparse wide", random_response(random, 16, 48, 0.15), 6, 8});
  all.push_back({"dense tall", random_response(random, 50, 20, 1.0), 4, 5});
  all.push_back({"sparse tall", random_response(random, 60, 24, 0.1), 4, 6});
  const Response base = random_response(random, 10, 30, 0.5);
  const std::vector<std::int32_t> twice{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2, 3, 3, 3};
  all.push_back({"duplicated rows", with_rows(base, twice, std::vector<double>(16, 1.0)), 5, 6});
  const std::vector<std::int32_t> blind{0, -1, 2, -1, 4, 5, -1, 7, 8, 9};
  all.push_back({"zero rows", with_rows(base, blind, std::vector<double>(10, 1.0)), 5, 6});
  all.push_back({"zero columns", without_columns(random_response(random, 14, 30, 0.7), 4), 5, 6});
  all.push_back({"scaled rows", with_rows(base, {0, 1, 2, 3, 4, 5}, {1, 10, 0.1, 3, 0.03, 1}), 5, 6});
  return all;
}

struct Setting {
  BasisKind basis;
  ConstraintKind constraint;
  double lambda;
};

}  // namespace

TEST_CASE("l1 solvers reach the reference's objective to 1e-4 on every kind of problem, basis and constraint") {
  Random random(72);
  int compared = 0;
  for (const Problem& problem : problems()) {
    for (const Setting& setting : {Setting{BasisKind::identity, ConstraintKind::none, 0.2},
                                   {BasisKind::identity, ConstraintKind::nonnegative, 0.05},
                                   {BasisKind::identity, ConstraintKind::box, 0.5},
                                   {BasisKind::dct, ConstraintKind::none, 0.1},
                                   {BasisKind::dct, ConstraintKind::nonnegative, 0.2},
                                   {BasisKind::dct, ConstraintKind::box, 0.02},
                                   {BasisKind::haar, ConstraintKind::none, 0.1},
                                   {BasisKind::haar, ConstraintKind::box, 0.05},
                                   {BasisKind::db4, ConstraintKind::nonnegative, 0.05},
                                   {BasisKind::dft, ConstraintKind::none, 0.2},
                                   {BasisKind::dft, ConstraintKind::box, 0.1},
                                   {BasisKind::tv, ConstraintKind::none, 0.1},
                                   {BasisKind::tv, ConstraintKind::nonnegative, 0.05},
                                   {BasisKind::tv, ConstraintKind::box, 0.2}}) {
      CAPTURE(problem.name);
      CAPTURE(static_cast<int>(setting.basis));
      CAPTURE(static_cast<int>(setting.constraint));
      const int n = problem.rows * problem.cols;
      std::vector<double> truth(static_cast<std::size_t>(n), 0.0), y(static_cast<std::size_t>(problem.a.rows()));
      for (double& v : truth) v = random.uniform() < 0.3 ? random.uniform(0.2, 1.0) : 0.0;
      problem.a.forward(truth, y);
      for (double& v : y) v = v == 0.0 ? 0.0 : static_cast<float>(v + 0.05 * random.normal());  // blind rows read 0
      recon::Objective objective;
      objective.basis = setting.basis;
      objective.constraint = setting.constraint;
      objective.lambda = setting.lambda;
      const auto best = recon::reference::solve_reference(problem.a, problem.rows, problem.cols, objective, y);
      REQUIRE(best.converged);
      for (const auto solver_kind : {SolverKind::admm, SolverKind::fista, SolverKind::chambolle_pock}) {
        if (!recon::supports(solver_kind, setting.basis, setting.constraint)) continue;
        CAPTURE(recon::name(solver_kind));
        recon::Plan plan;
        plan.solver = solver_kind;
        plan.iterations = 5000;
        const auto solver = recon::Reconstructor::create(problem.a, problem.rows, problem.cols, objective, plan);
        REQUIRE(solver.has_value());
        const SolvedFrame frame = solve_frame(*solver, to_float(y));
        const double reached =
            recon::reference::objective_value(problem.a, problem.rows, problem.cols, objective, y, {},
                                              std::vector<double>(frame.x.begin(), frame.x.end()));
        CHECK(reached <= best.objective * (1.0 + 1e-4) + 1e-7);
        CHECK(reached >= best.objective * (1.0 - 1e-6) - 1e-7);
        CHECK(frame.info.objective == doctest::Approx(reached).epsilon(1e-4));
        CHECK(frame.info.iterations == 5000);
        CHECK(frame.info.health == recon::Health::converged);
        ++compared;
      }
    }
  }
  CHECK(compared >= 40);
}

TEST_CASE("tikhonov is the closed form, in both precisions") {
  Random random(73);
  for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
    const Response a = random_response(random, 15, 24, 0.6);
    const auto y = to_float(random_vector(random, 15));
    recon::Objective objective;
    objective.lambda = 0.07;
    recon::Plan plan;
    plan.solver = recon::SolverKind::tikhonov;
    plan.precision = precision;
    const auto solver = recon::Reconstructor::create(a, 4, 6, objective, plan);
    REQUIRE(solver.has_value());
    const SolvedFrame frame = solve_frame(*solver, y);
    // Optimality: A'(A x - y) + lambda x = 0.
    std::vector<double> x(frame.x.begin(), frame.x.end()), r(15), g(24);
    a.forward(x, r);
    for (std::size_t m = 0; m < 15; ++m) r[m] -= static_cast<double>(y[m]);
    a.adjoint(r, g);
    for (std::size_t n = 0; n < 24; ++n) CHECK(std::abs(g[n] + 0.07 * x[n]) < 2e-5);
    CHECK(frame.info.iterations == 1);
    CHECK(frame.info.health == recon::Health::converged);
  }
}
