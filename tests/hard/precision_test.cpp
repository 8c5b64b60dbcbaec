// How far float32 and rounded responses carry: beside double along the way, and to where each breaks, by bisection.

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "studies/stability/hard_responses.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/hard_judge.hpp"
#include "tests/hard/hard_run.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::Precision;
using recon::solver_named;

#if !defined(COMPUEYE_SANITIZED)  // thousands of judgements in double

namespace {

HardRow row_of(recon::Response (*eye)(), firmware::ResponseChange change = {}) {
  return {.hard = {.name = "precision", .reason = "None.", .response = change, .snr_db = 40.0, .lambda_share = 1e-2},
          .eye = eye};
}

/// The largest decade of `amount` up to which `holds`, to a sixteenth of a decade.
double breaks_at(double least, double most, const std::function<bool(double)>& holds) {
  if (!holds(std::pow(10.0, least))) return least;
  if (holds(std::pow(10.0, most))) return most;
  while (most - least > 1.0 / 16.0) {
    const double middle = 0.5 * (least + most);
    (holds(std::pow(10.0, middle)) ? least : most) = middle;
  }
  return least;
}

/// The mean raised by `amount` without noise, at a lambda that asks for the details all the same.
struct Raised {
  explicit Raised(double amount)
      : row(row_of(ordinary_eye, {firmware::raised, amount})), problem(pose_it(amount)), judge(problem) {}

  firmware::HardProblem pose_it(double amount) {
    row.hard.snr_db = std::numeric_limits<double>::infinity();
    row.hard.lambda_share = 1e-3 / ((1.0 + amount) * (1.0 + amount));
    return firmware::pose(row.hard, row.eye(), 1);
  }

  HardRow row;
  firmware::HardProblem problem;
  HardJudge judge;
};

}  // namespace

TEST_CASE("float32 goes beside double along the iterations") {
  for (const auto& eye : {ordinary_eye, measured_rows, eye_of_60_deg}) {
    HardRow row = row_of(eye);
    const firmware::HardProblem problem = firmware::pose(row.hard, row.eye(), 1);
    HardJudge judge(problem);
    for (HardSetting setting : settings_of(row)) {
      if (!setting.solver->minimises || setting.precision != Precision::f32) continue;
      for (const int iterations : {1, 3, 10, 40, 160, 640}) {
        CAPTURE(setting.name());
        CAPTURE(iterations);
        row.iterations = iterations;
        setting.precision = Precision::f32;
        const HardRun single = run(row, setting, problem);
        setting.precision = Precision::f64;
        const HardRun twice = run(row, setting, problem);
        REQUIRE_FALSE(single.refused);
        REQUIRE_FALSE(twice.refused);
        const double reached = judge.value(single.objective, setting.solver, judge.picture(single.x));
        const double right = judge.value(twice.objective, setting.solver, judge.picture(twice.x));
        // On the way a few modes may be stored in fewer digits; at its end nothing of that is left.
        const bool at_end = iterations >= 640;
        CHECK(reached <= right * (at_end ? 1.002 : 1.05) + (at_end ? 1e-6 : 1e-3) * judge.value_of_dark());
      }
    }
  }
}

TEST_CASE("where float32 breaks is far beyond any eye, and health says so before") {
  struct Floor {
    const char* solver;
    double decades;  ///< by which the mean may stand above the details
  };
  for (const Floor& floor :
       {Floor{"admm", 3.5}, Floor{"adm", 1.5}, Floor{"cp", 4.5}, Floor{"fista", 5.0}, Floor{"pdhg", 4.5}}) {
    CAPTURE(floor.solver);
    const auto holds = [&](double amount) {
      Raised raised(amount);
      HardSetting setting{solver_named(floor.solver), recon::BasisKind::identity, recon::ConstraintKind::nonnegative,
                          Precision::f32};
      const HardRun single = run(raised.row, setting, raised.problem);
      setting.precision = Precision::f64;
      const HardRun twice = run(raised.row, setting, raised.problem);
      if (single.refused || twice.refused) return false;
      HardJudge& judge = raised.judge;
      const double reached = judge.value(single.objective, setting.solver, judge.picture(single.x));
      const double right = judge.value(twice.objective, setting.solver, judge.picture(twice.x));
      const bool holding = reached <= 1.01 * right;
      const std::optional<double> least = judge.least(single.objective);
      if (least && single.info.health == recon::Health::converged) CHECK(reached <= 1.002 * *least);
      return holding;
    };
    const double found = breaks_at(0.0, 7.0, holds);
    std::printf("%s in float32 comes as near as in double until the mean stands 10^%.1f above the details\n",
                floor.solver, found);
    CHECK(found >= floor.decades);
  }
}

TEST_CASE("a response is not rounded where that would make another problem of it") {
  struct Floor {
    recon::OperatorKind kind;
    double decades;
  };
  for (const Floor& floor :
       {Floor{recon::OperatorKind::dense_runs_bf16, 1.0}, Floor{recon::OperatorKind::dense_runs_int8, 0.5}}) {
    bool fell_back = false;
    const auto holds = [&](double amount) {
      Raised raised(amount);
      const HardSetting setting{solver_named("admm"), recon::BasisKind::identity, recon::ConstraintKind::nonnegative,
                                Precision::f32};
      recon::Plan plan = plan_of(raised.row, setting, raised.problem);
      const recon::Objective objective = objective_of(raised.row, setting, raised.problem);
      const HardRun whole = run(objective, plan, raised.problem);
      plan.op = floor.kind;
      const HardRun rounded = run(objective, plan, raised.problem);
      if (rounded.refused || whole.refused) return false;
      CHECK(rounded.info.health != recon::Health::invalid);
      fell_back = rounded.info.point.op != floor.kind;
      const auto worth = [&](const HardRun& done) {
        return raised.judge.value(objective, setting.solver, raised.judge.picture(done.x));
      };
      return worth(rounded) <= 2.0 * worth(whole);
    };
    for (const double decades : {-2.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0}) {
      CAPTURE(decades);
      CHECK(holds(std::pow(10.0, decades)));
      if (decades <= floor.decades) CHECK_FALSE(fell_back);
    }
    const double guarded = breaks_at(-2.0, 4.0, [&](double amount) { return holds(amount) && !fell_back; });
    std::printf("%s is used until the mean stands 10^%.1f above the details\n",
                std::string(recon::name(floor.kind)).c_str(), guarded);
  }
}

#endif
