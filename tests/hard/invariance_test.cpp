// What must not matter: the unit, the order of rows, rows that see nothing, and what a masked channel reads.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "studies/stability/hard_responses.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/hard_run.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/relative_difference.hpp"

using namespace compueye;
using namespace compueye::tests;
using firmware::HardProblem;

namespace {

HardRow row_of(recon::Response (*eye)()) {
  return {.hard = {.name = "an ordinary problem", .reason = "None."}, .eye = eye, .iterations = 60};
}

/// The rows `order` of a response; -1: a blind one.
HardProblem with_rows(const HardProblem& from, const std::vector<int>& order, float blind_reads) {
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  HardProblem made{from.a, from.truth, {}, {}, from.rms};
  for (const int m : order) {
    if (m >= 0) {
      from.a.for_each_in_row(m, [&](std::int32_t n, double v) { columns.push_back(n), values.push_back(v); });
    }
    start.push_back(static_cast<std::int64_t>(values.size()));
    made.y.push_back(m < 0 ? blind_reads : from.y[static_cast<std::size_t>(m)]);
  }
  made.a = recon::Response::from_csr(static_cast<int>(order.size()), from.a.cols(), start, columns, values)
               .value()
               .with_image(from.a.image_rows(), from.a.image_cols())
               .value();
  return made;
}

std::vector<int> counted(int n) {
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

bool same_bits(const HardRun& a, const HardRun& b) {
  return !a.refused && !b.refused && a.x == b.x && a.info.objective == b.info.objective &&
         a.info.residual == b.info.residual && a.info.health == b.info.health;
}

}  // namespace

TEST_CASE("A and y times powers of two give the picture times a power of two, bit for bit") {
  struct Scaling {
    int a, y;
  };
  constexpr Scaling scalings[]{{3, -2}, {-7, 5}, {20, -25}, {-30, 20}, {40, -40}, {-60, 30}, {-100, -100}, {100, 100}};
  for (const auto& eye : {ordinary_eye, measured_rows}) {
    const HardRow row = row_of(eye);
    const HardProblem problem = firmware::pose(row.hard, eye(), 1);
    for (const HardSetting& setting : settings_of(row)) {
      const HardRun plain = run(row, setting, problem);
      REQUIRE_FALSE(plain.refused);
      for (const Scaling& by : scalings) {
        HardProblem scaled = problem;
        scaled.a = firmware::scaled(problem.a, std::ldexp(1.0, by.a));
        for (float& value : scaled.y) value = std::ldexp(value, by.y);
        recon::Objective objective = objective_of(row, setting, scaled);
        objective.hi = std::ldexp(objective.hi, by.y - by.a);
        HardRun run_scaled = run(objective, plan_of(row, setting, scaled), scaled);
        for (float& value : run_scaled.x) value = std::ldexp(value, by.a - by.y);
        const auto figures_follow = [&] {
          const double square = std::ldexp(1.0, 2 * by.y);
          return run_scaled.info.health == plain.info.health &&
                 run_scaled.info.objective == square * plain.info.objective &&
                 run_scaled.info.residual == std::ldexp(plain.info.residual, by.y) &&
                 run_scaled.info.duality_gap == (plain.info.duality_gap > 0.0 ? square : 1.0) * plain.info.duality_gap;
        };
        if (!run_scaled.refused && run_scaled.x == plain.x && figures_follow()) continue;
        FAIL_CHECK(setting.name() << ", A times 2^" << by.a << ", y times 2^" << by.y << ": "
                                  << (run_scaled.refused ? run_scaled.refused->text()
                                                         : std::to_string(relative_difference(run_scaled.x, plain.x))));
      }
    }
  }
}

TEST_CASE("y and lambda times any c give c times the picture, to rounding") {
  const HardRow row = row_of(measured_rows);
  const HardProblem problem = firmware::pose(row.hard, row.eye(), 6);
  for (const HardSetting& setting : settings_of(row)) {
    CAPTURE(setting.name());
    const HardRun plain = run(row, setting, problem);
    REQUIRE_FALSE(plain.refused);
    for (const double c : {1e-30, 1e-9, 4095.0, 1e30}) {
      CAPTURE(c);
      HardProblem scaled = problem;
      for (float& value : scaled.y) value = static_cast<float>(c * static_cast<double>(value));
      recon::Objective objective = objective_of(row, setting, problem);
      if (setting.solver->lambda != recon::LambdaUse::variances) objective.lambda *= c;
      objective.hi *= c;
      HardRun other = run(objective, plan_of(row, setting, problem), scaled);
      REQUIRE_FALSE(other.refused);
      for (float& value : other.x) value = static_cast<float>(static_cast<double>(value) / c);
      CHECK(other.info.health == plain.info.health);
      CHECK(other.info.objective / (c * c) == doctest::Approx(plain.info.objective).epsilon(1e-3));
      CHECK(relative_difference(other.x, plain.x) < (setting.precision == recon::Precision::f32 ? 1e-2 : 1e-4));
    }
  }
}

TEST_CASE("an epsilon has the unit of y, and what it costs that of x") {
  const HardProblem problem = firmware::pose(row_of(measured_rows).hard, measured_rows(), 7);
  const double size = std::sqrt(std::inner_product(problem.y.begin(), problem.y.end(), problem.y.begin(), 0.0));
  recon::Plan plan;
  for (const char* solver : {"adm", "omp"}) {
    CAPTURE(solver);
    plan.solver = recon::solver_named(solver);
    recon::Objective objective;
    objective.epsilon = 0.05 * size;
    const HardRun plain = run(objective, plan, problem);
    REQUIRE_FALSE(plain.refused);
    HardProblem scaled = problem;
    for (float& value : scaled.y) value = std::ldexp(value, -80);
    objective.epsilon = std::ldexp(*objective.epsilon, -80);
    HardRun other = run(objective, plan, scaled);
    REQUIRE_FALSE(other.refused);
    for (float& value : other.x) value = std::ldexp(value, 80);
    CHECK(other.x == plain.x);
    CHECK(other.info.residual == std::ldexp(plain.info.residual, -80));
    CHECK(other.info.objective == std::ldexp(plain.info.objective, plan.solver->minimises ? -80 : -160));
  }
}

TEST_CASE("the order of the rows changes nothing beyond rounding") {
  const HardRow row = row_of(measured_rows);
  const HardProblem problem = firmware::pose(row.hard, row.eye(), 2);
  std::vector<int> order = counted(problem.a.rows());
  Random random(8);
  for (std::size_t k = order.size(); k > 1; --k) {
    std::swap(order[k - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  }
  const HardProblem permuted = with_rows(problem, order, 0.0F);
  for (const HardSetting& setting : settings_of(row)) {
    CAPTURE(setting.name());
    const HardRun plain = run(row, setting, problem), other = run(row, setting, permuted);
    REQUIRE_FALSE(plain.refused);
    REQUIRE_FALSE(other.refused);
    const bool single = setting.precision == recon::Precision::f32;
    CHECK(other.info.health == plain.info.health);
    CHECK(other.info.objective == doctest::Approx(plain.info.objective).epsilon(single ? 1e-3 : 1e-9));
    CHECK(relative_difference(other.x, plain.x) < (single ? 1e-2 : 1e-6));  // pictures are float32
  }
}

TEST_CASE("a blind row changes no bit, whatever it reads") {
  for (const auto& eye : {ordinary_eye, measured_rows}) {
    const HardRow row = row_of(eye);
    const HardProblem problem = firmware::pose(row.hard, row.eye(), 3);
    std::vector<int> order = counted(problem.a.rows());
    order.insert(order.begin() + 7, -1);
    order.insert(order.begin(), -1);
    order.push_back(-1);
    for (const HardSetting& setting : settings_of(row)) {
      CAPTURE(setting.name());
      const HardRun plain = run(row, setting, with_rows(problem, counted(problem.a.rows()), 0.0F));
      for (const float reads : {0.0F, 3.0F, std::numeric_limits<float>::quiet_NaN()}) {
        CHECK(same_bits(run(row, setting, with_rows(problem, order, reads)), plain));
      }
    }
  }
}

TEST_CASE("what a masked channel reads never matters") {
  const HardRow row = row_of(measured_rows);
  HardProblem problem = firmware::pose(row.hard, row.eye(), 4);
  problem.weights.assign(problem.y.size(), 1.0F);
  problem.weights[2] = problem.weights[11] = 0.0F;
  problem.weights[5] = 0.5F;
  for (const HardSetting& setting : settings_of(row)) {
    CAPTURE(setting.name());
    const HardRun plain = run(row, setting, problem);
    for (const float reads :
         {0.0F, -1e30F, 1e-40F, std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
      HardProblem other = problem;
      other.y[2] = other.y[11] = reads;
      // lambda is a figure of the weighted samples, so it is the same.
      CHECK(same_bits(run(row, setting, other), plain));
    }
  }
}
