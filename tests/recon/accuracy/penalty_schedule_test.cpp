#include "recon/setup/penalty_rule.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/eyes.hpp"
#include "calib/nominal.hpp"
#include "recon/solver_list.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::recon;
using namespace compueye::tests;

namespace {

Plan plan_of(SolverKind solver, double rho = 0.0) {
  Plan plan;
  plan.solver = solver;
  plan.rho = rho;
  return plan;
}

Objective l1_objective(BasisKind basis, double lambda) {
  Objective objective;
  objective.basis = basis;
  objective.constraint = ConstraintKind::nonnegative;
  objective.lambda = lambda;
  return objective;
}

constexpr int many_rows = 6400;  // more than there are modes by rule

/// Mean NMSE over scenes of a few dots at 30 dB, in 22 iterations.
double mean_error(const Response& a, double rho) {
  Random random(21);
  double sum = 0.0;
  constexpr int scenes = 300;
  for (int s = 0; s < scenes; ++s) {
    const hal::Image truth = sim::render_built_in("dots", 16, 16, 2000 + static_cast<std::uint64_t>(s)).value();
    std::vector<double> y(static_cast<std::size_t>(a.rows()));
    a.forward(std::vector<double>(truth.pixels.begin(), truth.pixels.end()), y);
    double power = 0.0;
    for (const double v : y) power += v * v;
    const double sigma = std::sqrt(power / a.rows() / 1000.0);
    for (double& v : y) v += sigma * random.normal();
    Plan plan = plan_of(solver_named("admm"), rho);
    plan.iterations = 22;
    const auto solver = Reconstructor::create(a, l1_objective(BasisKind::identity, 4.0 * sigma), plan);
    REQUIRE(solver.has_value());
    const SolvedFrame frame = solve_frame(*solver, to_float(y));
    double error = 0.0, size = 0.0;
    for (std::size_t k = 0; k < frame.x.size(); ++k) {
      error += std::pow(static_cast<double>(frame.x[k]) - static_cast<double>(truth.pixels[k]), 2);
      size += std::pow(static_cast<double>(truth.pixels[k]), 2);
    }
    sum += error / size / scenes;
  }
  return sum;
}

}  // namespace

TEST_CASE("admm in pixels goes down from rho, back to it, and ends there") {
  const PenaltyLevels dip =
      penalty_levels(l1_objective(BasisKind::identity, 0.1), plan_of(solver_named("admm"), 3.0), true, 64, true);
  const auto least = std::min_element(dip.penalties.begin(), dip.penalties.end());
  CHECK(*least == doctest::Approx(1.0));
  CHECK(dip.penalties.front() == doctest::Approx(4.0));
  CHECK(dip.penalties.back() == 3.0);
  CHECK(std::is_sorted(dip.penalties.begin(), least + 1, std::greater<>()));
  CHECK(std::is_sorted(least, dip.penalties.end()));
}

TEST_CASE("pdhg rises from rho to twice rho where lambda leaves it time") {
  const auto levels = [](double lambda, BasisKind basis = BasisKind::dct, int order = many_rows) {
    return penalty_levels(l1_objective(basis, lambda), plan_of(solver_named("pdhg"), 7.0), true, order, true).penalties;
  };
  for (const double lambda : {0.0, 0.2, 2.0}) {
    const auto rise = levels(lambda);
    CHECK(rise.size() > 1);
    CHECK(rise.front() == 7.0);
    CHECK(rise.back() == doctest::Approx(14.0));
    CHECK(std::is_sorted(rise.begin(), rise.end()));
  }
  CHECK(levels(3.0).back() == doctest::Approx(0.6 * 49.0 / 3.0));
  CHECK(levels(7.0) == std::vector<double>{7.0});
  CHECK(levels(0.2, BasisKind::tv) == std::vector<double>{7.0});
  CHECK(levels(0.2, BasisKind::dct, 64) == std::vector<double>{7.0});  // every mode is known
}

TEST_CASE("pdhg comes down from above rho where no symmetry is left") {
  const auto levels = [](double lambda) {
    return penalty_levels(l1_objective(BasisKind::dct, lambda), plan_of(solver_named("pdhg"), 7.0), true, many_rows,
                          false)
        .penalties;
  };
  const auto fall = levels(0.2);
  CHECK(fall.front() == doctest::Approx(17.5));
  CHECK(fall.back() == doctest::Approx(10.0));
  CHECK(std::is_sorted(fall.begin(), fall.end(), std::greater<>()));
  CHECK(levels(3.0).front() == doctest::Approx(0.6 * 49.0 / 3.0));
  CHECK(levels(3.0).back() == 7.0);
  CHECK(levels(7.0) == std::vector<double>{7.0});
}

TEST_CASE("a rho that was asked for stays") {
  for (const SolverKind solver : {solver_named("admm"), solver_named("pdhg")}) {
    for (const BasisKind basis : {BasisKind::identity, BasisKind::dct}) {
      const PenaltyLevels levels =
          penalty_levels(l1_objective(basis, 0.1), plan_of(solver, 5.0), false, many_rows, true);
      CHECK(levels.penalties == std::vector<double>{5.0});
    }
  }
}

TEST_CASE("the schedule follows the unit of the samples") {
  const auto rise = [](double unit) {
    return penalty_levels(l1_objective(BasisKind::dct, 3.0 * unit), plan_of(solver_named("pdhg"), 7.0 * unit), true,
                          many_rows, true)
        .penalties;
  };
  const auto one = rise(1.0), hundred = rise(100.0);
  REQUIRE(one.size() == hundred.size());
  for (std::size_t k = 0; k < one.size(); ++k) CHECK(hundred[k] == doctest::Approx(100.0 * one[k]));
}

TEST_CASE("in 22 iterations the schedule halves the error that the best constant penalties leave on a small eye") {
  const bench::Eye eye = bench::eye_8x8();
  const Response a = calib::nominal_response(eye.geometry, eye.plane).value();
  double squares = 0.0;
  for (const double v : a.values()) squares += v * v;
  const double rule = 0.06 * squares / a.cols();
  const double scheduled = mean_error(a, 0.0);
  CHECK(scheduled < 0.5 * mean_error(a, rule));
  for (const double share : {0.2, 0.4, 0.7, 1.5, 4.0}) CHECK(scheduled < mean_error(a, share * rule));
}
