#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "recon/solver_list.hpp"
#include "tests/recon/every_setting.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

struct Case {
  recon::Response a;
  std::vector<float> y;
  recon::Objective objective;
  recon::Plan plan;
};

Case make_case(recon::BasisKind basis, recon::ConstraintKind constraint) {
  Random random(81);
  Case c{random_response(random, 40, Picture{8, 10}, 0.3), {}, {}, {}};
  std::vector<double> truth(80, 0.0), y(40);
  for (double& v : truth) v = random.uniform() < 0.3 ? random.uniform(0.3, 1.0) : 0.0;
  c.a.forward(truth, y);
  for (double& v : y) v += 0.02 * random.normal();
  c.y = to_float(y);
  c.objective.basis = basis;
  c.objective.constraint = constraint;
  c.objective.lambda = 0.05;
  c.plan.iterations = 300;
  c.plan.max_reweighted = 40;
  return c;
}

/// The same problem with the weights in the rows, and a new factor made for it.
SolvedFrame solve_refactored(const Case& c, const std::vector<float>& weights, double rho) {
  std::vector<std::int32_t> rows;
  std::vector<double> scale;
  std::vector<float> y;
  for (std::size_t m = 0; m < weights.size(); ++m) {
    if (weights[m] == 0.0F) continue;
    rows.push_back(static_cast<std::int32_t>(m));
    scale.push_back(std::sqrt(static_cast<double>(weights[m])));
    y.push_back(c.y[m] * static_cast<float>(scale.back()));
  }
  recon::Plan plan = c.plan;
  plan.rho = rho;
  plan.precision = recon::Precision::f64;
  const auto solver = recon::Reconstructor::create(c.a.select_rows(rows, scale), c.objective, plan);
  return solve_frame(solver.value(), y);
}

}  // namespace

TEST_CASE("weights of a frame act like a new factor, to 1e-3, for every basis and constraint") {
  Random random(82);
  for (const auto basis : {recon::BasisKind::identity, recon::BasisKind::dct}) {
    for (const auto constraint :
         {recon::ConstraintKind::none, recon::ConstraintKind::nonnegative, recon::ConstraintKind::box}) {
      const Case c = make_case(basis, constraint);
      const auto solver = recon::Reconstructor::create(c.a, c.objective, c.plan);
      REQUIRE(solver.has_value());
      for (const double share : {0.0, 0.025, 0.05, 0.3, 0.9}) {
        std::vector<float> weights(40, 1.0F);
        for (float& w : weights) {
          if (random.uniform() < share)
            w = random.uniform() < 0.5 ? 0.0F : static_cast<float>(random.uniform(0.05, 1.0));
        }
        const SolvedFrame fast = solve_frame(*solver, c.y, weights);
        const SolvedFrame slow = solve_refactored(c, weights, solver->plan().rho);
        CHECK(relative_difference(fast.x, slow.x) < 1e-3);
        CHECK(fast.info.objective == doctest::Approx(slow.info.objective).epsilon(1e-3));
        CHECK(fast.info.channels_reweighted ==
              static_cast<int>(std::count_if(weights.begin(), weights.end(), [](float w) { return w != 1.0F; })));
      }
    }
  }
}

TEST_CASE("what a missing channel reads does not change a bit, NaN and infinity included") {
  const Case c = make_case(recon::BasisKind::dct, recon::ConstraintKind::box);
  for (const SolverSetting& setting : every_setting()) {
    CAPTURE(setting.name);
    const auto solver = recon::Reconstructor::create(c.a, setting.objective, setting.plan).value();
    std::vector<float> weights(40, 1.0F), y = c.y;
    weights[3] = weights[17] = 0.0F;
    const SolvedFrame plain = solve_frame(solver, y, weights);
    y[3] = std::nanf("");
    y[17] = HUGE_VALF;
    const SolvedFrame odd = solve_frame(solver, y, weights);
    CHECK(plain.info.health != recon::Health::invalid);
    CHECK(plain.x == odd.x);
    CHECK(plain.info.channels_used == 38);
    CHECK(plain.info.channels_reweighted == 2);
    CHECK(plain.x != solve_frame(solver, c.y).x);
  }
}

TEST_CASE("bad samples, bad weights and too many of them make a frame invalid, not wrong") {
  const Case c = make_case(recon::BasisKind::identity, recon::ConstraintKind::nonnegative);
  for (SolverSetting setting : every_setting()) {
    CAPTURE(setting.name);
    setting.plan.max_reweighted = 2;
    const auto solver = recon::Reconstructor::create(c.a, setting.objective, setting.plan).value();
    const auto check_invalid = [&](const std::vector<float>& y, const std::vector<float>& weights) {
      const SolvedFrame frame = solve_frame(solver, y, weights);
      CHECK(frame.info.health == recon::Health::invalid);
      CHECK(frame.info.duality_gap <= 0.0);
      CHECK(std::all_of(frame.x.begin(), frame.x.end(), [](float v) { return v == 0.0F; }));
    };
    std::vector<float> y = c.y, ones(40, 1.0F);
    y[5] = std::nanf("");
    check_invalid(y, ones);
    y[5] = -HUGE_VALF;
    check_invalid(y, {});
    for (const float bad : {-0.1F, 1.1F, std::nanf("")}) {
      std::vector<float> weights = ones;
      weights[0] = bad;
      check_invalid(c.y, weights);
    }
    std::vector<float> three = ones;
    three[1] = three[2] = three[3] = 0.0F;
    const bool by_factor =
        recon::uses_factor(setting.plan.solver) || setting.plan.solver == recon::solver_named("tsvd");
    if (by_factor) check_invalid(c.y, three);
    CHECK((solve_frame(solver, c.y, three).info.health == recon::Health::invalid) == by_factor);
    const SolvedFrame bright = solve_frame(solver, std::vector<float>(40, 3e38F), ones);
    CHECK(std::all_of(bright.x.begin(), bright.x.end(), [](float v) { return std::isfinite(v); }));
    CHECK(std::isfinite(bright.info.objective));
  }
}

TEST_CASE("a frame with every channel missing is black and not a failure") {
  const Case c = make_case(recon::BasisKind::dct, recon::ConstraintKind::box);
  for (SolverSetting setting : every_setting()) {
    CAPTURE(setting.name);
    setting.plan.max_reweighted = 40;
    const auto solver = recon::Reconstructor::create(c.a, setting.objective, setting.plan).value();
    const SolvedFrame frame = solve_frame(solver, c.y, std::vector<float>(40, 0.0F));
    CHECK(frame.info.health != recon::Health::invalid);
    CHECK(frame.info.channels_used == 0);
    for (const float v : frame.x) CHECK(std::abs(v) < 1e-6F);
  }
}
