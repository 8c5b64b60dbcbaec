// Huber's data term: against its other form, a lasso with a sample's own outlier as a pixel more, and by what it is
// for.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/recon/solver_problems.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::Health;
using recon::Precision;
using recon::Reconstructor;

namespace {

constexpr double lambda = 0.2, delta = 0.05;

/// A scene of a few lit pixels, its samples with a little noise, and some samples that read anything.
struct Outlying {
  Outlying() : a(measured_eye(3)) {
    Random random(17);
    std::vector<double> x(static_cast<std::size_t>(a.cols()), 0.0), y(static_cast<std::size_t>(a.rows()));
    for (const std::size_t lit : {12U, 45U, 46U, 78U}) x[lit] = 0.8;
    a.forward(x, y);
    for (double& value : y) value += 0.02 * (random.uniform() - 0.5);
    truth = to_float(x);
    sound = to_float(y);
    bad = sound;
    for (const std::size_t channel : {5U, 17U}) bad[channel] = 30.0F * static_cast<float>(1.0 + random.uniform());
  }
  recon::Response a;
  std::vector<float> truth, sound, bad;
};

recon::Objective objective_of(recon::ConstraintKind constraint = recon::ConstraintKind::none) {
  recon::Objective objective;
  objective.constraint = constraint;
  objective.lambda = lambda;
  objective.huber = delta;
  return objective;
}

/// min over x, s of 1/2 ||A x + s - y||^2 + lambda ||x||_1 + delta ||s||_1: the least over s is Huber's term.
double least_by_outlier_pixels(const recon::Response& a, const std::vector<float>& y) {
  const auto rows = static_cast<std::size_t>(a.rows()), pixels = static_cast<std::size_t>(a.cols());
  std::vector<double> values(rows * (pixels + rows), 0.0);
  for (std::size_t m = 0; m < rows; ++m) {
    a.for_each_in_row(static_cast<int>(m),
                      [&](std::int32_t n, double v) { values[m * (pixels + rows) + static_cast<std::size_t>(n)] = v; });
    values[m * (pixels + rows) + pixels + m] = lambda / delta;  // one lambda for both
  }
  const int width = a.cols() + a.rows();
  const auto joint = recon::Response::from_dense(a.rows(), width, values).value().with_image(1, width).value();
  recon::Objective objective = objective_of();
  objective.huber.reset();
  std::vector<double> samples(y.begin(), y.end());
  const auto best = recon::reference::solve_reference(joint, objective, samples);
  REQUIRE(best.converged);
  return best.objective;
}

recon::Plan plan_of(const char* solver, Precision precision = Precision::f64) {
  recon::Plan plan;
  plan.solver = recon::solver_named(solver);
  plan.precision = precision;
  plan.iterations = 3000;
  plan.max_reweighted = 20;
  return plan;
}

double error_of(const std::vector<float>& x, const std::vector<float>& truth) {
  return std::pow(relative_difference(x, truth), 2);
}

}  // namespace

TEST_CASE("Huber's optimum is that of outliers as pixels of their own") {
  const Outlying frame;
  for (const bool sound : {false, true}) {
    if (test::sanitized && sound) continue;
    const std::vector<float>& y = sound ? frame.sound : frame.bad;
    const double least = least_by_outlier_pixels(frame.a, y);
    for (const char* solver : {"admm", "pdhg", "cp", "adm"}) {
      CAPTURE(solver);
      for (const auto precision : {Precision::f32, Precision::f64}) {
        if (test::sanitized && precision == Precision::f64) continue;
        const auto reconstructor = Reconstructor::create(frame.a, objective_of(), plan_of(solver, precision)).value();
        const SolvedFrame solved = solve_frame(reconstructor, y);
        CHECK(solved.info.objective >= least * (1.0 - 1e-4));
        CHECK(solved.info.objective <= least * 1.01);
        CHECK(solved.info.duality_gap < 0.0);
      }
    }
  }
}

TEST_CASE("samples far off do not decide a picture with Huber's term, and without them it changes no bit") {
  const Outlying frame;
  for (const auto constraint : {recon::ConstraintKind::nonnegative, recon::ConstraintKind::box}) {
    recon::Objective with = objective_of(constraint), without = with;
    without.huber.reset();
    const auto plan = plan_of("admm", Precision::f32);
    const auto robust = Reconstructor::create(frame.a, with, plan).value();
    const auto plain = Reconstructor::create(frame.a, without, plan).value();
    const double sound = error_of(solve_frame(plain, frame.sound).x, frame.truth);
    const SolvedFrame bent = solve_frame(robust, frame.bad);
    CHECK(error_of(solve_frame(plain, frame.bad).x, frame.truth) > 1000.0 * sound);
    CHECK(error_of(bent.x, frame.truth) < 5.0 * sound);  // what an outlier still pulls is delta
    CHECK(bent.info.channels_reweighted >= 2);
    with.huber = 100.0;
    const auto never = Reconstructor::create(frame.a, with, plan).value();
    CHECK(solve_frame(never, frame.sound).x == solve_frame(plain, frame.sound).x);
  }
}

TEST_CASE("more outliers than a frame may weigh are said by its health, masked ones do not count") {
  const Outlying frame;
  recon::Plan plan = plan_of("admm", Precision::f32);
  plan.max_reweighted = 1;
  const auto narrow = Reconstructor::create(frame.a, objective_of(), plan).value();
  CHECK(solve_frame(narrow, frame.bad).info.health == Health::budget_used);
  CHECK(solve_frame(narrow, frame.bad).info.channels_reweighted == 1);
  std::vector<float> weights(frame.bad.size(), 1.0F), y = frame.bad;
  weights[5] = 0.0F;
  y[5] = std::nanf("");
  plan.max_reweighted = 20;
  const auto wide = Reconstructor::create(frame.a, objective_of(), plan).value();
  const SolvedFrame masked = solve_frame(wide, y, weights);
  CHECK(masked.info.health != Health::invalid);
  y[5] = 1e30F;
  CHECK(solve_frame(wide, y, weights).x == masked.x);
}

TEST_CASE("a bound that is none, and what has no sum of squares to bend, are refused by name") {
  const Outlying frame;
  recon::Objective objective = objective_of();
  for (const double bound : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    objective.huber = bound;
    test::check_error(Reconstructor::create(frame.a, objective, plan_of("admm")), hal::ErrorCode::out_of_range, "huber",
                      {"0"});
  }
  objective = objective_of();
  for (const char* solver : {"omp", "tsvd", "tikhonov"}) {
    test::check_error(Reconstructor::create(frame.a, objective, plan_of(solver)), hal::ErrorCode::usage, "huber",
                      {"admm", "pdhg"});
  }
  objective.epsilon = 0.1;
  test::check_error(Reconstructor::create(frame.a, objective, plan_of("adm")), hal::ErrorCode::usage, "huber",
                    {"epsilon"});
}
