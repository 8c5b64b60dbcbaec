// What must not matter: the unit, the order of rows, rows that see nothing, and what a masked channel reads.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
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
    const char* waits_for;
  };
  constexpr const char* unit = "a change of unit changes nothing but the unit";
  const Scaling scalings[]{{3, -2, ""},     {-7, 5, ""},     {20, -25, unit},    {-30, 20, unit},
                           {40, -40, unit}, {-60, 30, unit}, {-100, -100, unit}, {100, 100, unit}};
  int waiting = 0, compared = 0;
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
        ++compared;
        if (!run_scaled.refused && run_scaled.x == plain.x) continue;
        if (*by.waits_for != 0) {
          ++waiting;
          continue;
        }
        FAIL_CHECK(setting.name() << ", A times 2^" << by.a << ", y times 2^" << by.y << ": "
                                  << (run_scaled.refused ? run_scaled.refused->text()
                                                         : std::to_string(relative_difference(run_scaled.x, plain.x))));
      }
    }
  }
  std::printf("%d compared\n", compared);
  if (waiting > 0) std::printf("waits for %s: %d\n", unit, waiting);
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
