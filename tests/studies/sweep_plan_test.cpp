#include "studies/accuracy_and_time/sweep_plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "firmware/operating_points/machine.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "tests/studies/boards.hpp"

using namespace compueye;
using namespace compueye::firmware;
using recon::BasisKind;
using recon::Precision;
using recon::solver_named;
using recon::SolverKind;

namespace {

Board some_board() {
  Board board = test::board_8x8();
  board.objective.basis = BasisKind::tv;
  board.plan.iterations = 17;
  return board;
}

SweepPlan plan_of(const SweepOptions& options, int seeing = 64) {
  auto plan = plan_sweep(some_board(), options, seeing);
  REQUIRE(plan.has_value());
  return *plan;
}

}  // namespace

TEST_CASE("only what goes together is swept, with the board's constraint where it is taken") {
  const SweepPlan plan = plan_of({});
  for (const PlannedCurve& planned : plan.curves) {
    const Curve& c = planned.curve;
    CHECK(recon::supports(c.solver, c.basis, c.constraint));
    CHECK((c.constraint == recon::ConstraintKind::box ||
           !recon::supports(c.solver, c.basis, recon::ConstraintKind::box)));
    CHECK_FALSE(planned.iterations.empty());
    CHECK(std::is_sorted(planned.iterations.begin(), planned.iterations.end()));
    CHECK(std::adjacent_find(planned.iterations.begin(), planned.iterations.end()) == planned.iterations.end());
    CHECK(std::count_if(plan.curves.begin(), plan.curves.end(), [&](const auto& o) { return o.curve == c; }) == 1);
  }
  for (const auto& solver : recon::solver_names()) {
    CAPTURE(solver.name);
    CHECK(std::any_of(plan.curves.begin(), plan.curves.end(),
                      [&](const PlannedCurve& p) { return p.curve.solver == solver.kind; }));
  }
}

TEST_CASE("the board's own point comes first and is among those of its curve, quick or not") {
  for (const SolverKind solver : {solver_named("admm"), solver_named("pdhg")}) {
    for (const bool quick : {false, true}) {
      SweepOptions options;
      options.quick = quick;
      Board board = some_board();
      board.plan.solver = solver;
      const SweepPlan plan = plan_sweep(board, options, 64).value();
      const PlannedCurve& first = plan.curves.front();
      CHECK(first.curve.solver == solver);
      CHECK(first.curve.basis == BasisKind::tv);
      CHECK(std::count(first.iterations.begin(), first.iterations.end(), 17) == 1);
    }
  }
}

TEST_CASE("options leave out solvers and bases, and names that do not exist are errors") {
  SweepOptions options;
  options.solvers = {"admm", "cp"};
  options.bases = {"dct"};
  const SweepPlan plan = plan_of(options);
  REQUIRE(plan.curves.size() == 2);
  CHECK(title(plan.curves[0].curve) == "admm dct");
  CHECK(title(plan.curves[1].curve) == "cp dct");
  for (const auto& [solver, basis] : {std::pair{"amdm", "dct"}, std::pair{"admm", "dtc"}, std::pair{"tsvd", "tv"}}) {
    options.solvers = {solver};
    options.bases = {basis};
    const auto refused = plan_sweep(some_board(), options, 64);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == hal::ErrorCode::usage);
  }
}

TEST_CASE("what takes minutes on a large eye is left out with a note, unless it is asked for") {
  const auto has = [](const SweepPlan& plan, SolverKind solver, Precision precision) {
    return std::any_of(plan.curves.begin(), plan.curves.end(), [&](const PlannedCurve& p) {
      return p.curve.solver == solver && p.curve.precision == precision;
    });
  };
  CHECK(has(plan_of({}), solver_named("tsvd"), Precision::f32));
  CHECK(has(plan_of({}), solver_named("admm"), Precision::f64));
  const SweepPlan large = plan_of({}, 5000);
  CHECK_FALSE(has(large, solver_named("tsvd"), Precision::f32));
  CHECK_FALSE(has(large, solver_named("admm"), Precision::f64));
  CHECK(has(large, solver_named("admm"), Precision::f32));
  CHECK(large.notes.size() == 6);
  SweepOptions options;
  options.solvers = {"tsvd"};
  CHECK(has(plan_of(options, 5000), solver_named("tsvd"), Precision::f32));
}

TEST_CASE("what can go on from the last frame does so with and without motion, everything else starts cold") {
  int warm = 0;
  for (const PlannedCurve& planned : plan_of({}).curves) {
    const Board board = with_curve(some_board(), planned.curve);
    CHECK(board.plan.warm_start == (planned.curve.motion != Motion::none));
    CHECK((planned.curve.motion == Motion::none || planned.curve.solver == solver_named("pdhg")));
    if (planned.curve.motion != Motion::none) ++warm;
  }
  CHECK(warm == 2);
}

TEST_CASE("a thread a core is one curve of its own, on a machine that has cores to share") {
  int shared = 0;
  for (const PlannedCurve& planned : plan_of({}).curves) {
    CHECK(with_curve(some_board(), planned.curve).plan.threads == planned.curve.threads);
    if (planned.curve.threads == 1) continue;
    ++shared;
    CHECK(title(planned.curve).find("threads") != std::string::npos);
  }
  CHECK(shared == (this_machine().cores > 1 ? 1 : 0));
}
