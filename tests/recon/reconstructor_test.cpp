#include "recon/reconstructor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/every_setting.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::tests;
using hal::ErrorCode;
using recon::Reconstructor;

namespace {

recon::Response some_response() {
  Random random(91);
  return random_response(random, 20, Picture{6, 8}, 0.4);
}

recon::Objective dct_box(double lambda) {
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = lambda;
  return objective;
}

}  // namespace

TEST_CASE("set-up refuses what makes no sense, and says what it expected") {
  const recon::Response a = some_response();
  const auto code = [&](const recon::Objective& objective, const recon::Plan& plan) {
    const auto made = Reconstructor::create(a, objective, plan);
    REQUIRE_FALSE(made.has_value());
    CHECK_FALSE(made.error().sentence.empty());
    return made.error().code;
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  CHECK(a.with_image(6, 9).error().code == ErrorCode::mismatch);
  CHECK(Reconstructor::create(a.with_image(0, 0).value(), dct_box(0.1), {}).error().code == ErrorCode::mismatch);
  for (const double lambda : {-1.0, nan, inf}) CHECK(code(dct_box(lambda), {}) == ErrorCode::out_of_range);
  for (const int iterations : {0, -3, 1'000'001}) {
    recon::Plan plan;
    plan.iterations = iterations;
    CHECK(code(dct_box(0.1), plan) == ErrorCode::out_of_range);
  }
  for (const double relaxation : {0.0, 2.0, nan}) {
    recon::Plan plan;
    plan.relaxation = relaxation;
    CHECK(code(dct_box(0.1), plan) == ErrorCode::out_of_range);
  }
  recon::Objective box = dct_box(0.1);
  box.lo = 1.0;
  CHECK(code(box, {}) == ErrorCode::out_of_range);
  recon::Plan tikhonov;
  tikhonov.solver = recon::solver_named("tikhonov");
  CHECK(code(dct_box(0.1), tikhonov) == ErrorCode::usage);
  const auto blind = recon::Response::from_dense(3, 4, std::vector<double>(12, 0.0)).value().with_image(2, 2).value();
  const auto nothing_seen = Reconstructor::create(blind, {}, {});
  test::check_error(nothing_seen, ErrorCode::out_of_range, "response", {});
  CHECK_FALSE(test::names(nothing_seen.error().sentence, "1e-12"));  // the least that a response may be scaled to
}

TEST_CASE("another number of iterations gives the frames of a solver made with it") {
  const recon::Response a = some_response();
  recon::Plan plan;
  plan.iterations = 7;
  auto changed = Reconstructor::create(a, dct_box(0.1), plan).value();
  plan.iterations = 31;
  const auto made = Reconstructor::create(a, dct_box(0.1), plan).value();
  const std::vector<float> y(20, 1.0F);
  CHECK(solve_frame(changed, y).x != solve_frame(made, y).x);
  REQUIRE(changed.set_iterations(31));
  CHECK(changed.plan().iterations == 31);
  CHECK(changed.operating_point().iterations == 31);
  CHECK(solve_frame(changed, y).x == solve_frame(made, y).x);
  CHECK(changed.set_iterations(0).error().code == ErrorCode::out_of_range);
  CHECK(changed.plan().iterations == 31);
}

TEST_CASE("a stored factor is used when it fits and refused when stale") {
  const recon::Response a = some_response();
  const auto first = Reconstructor::create(a, dct_box(0.1), {}).value();
  const std::vector<float> y(20, 1.0F);
  const auto again = Reconstructor::create(a, dct_box(0.1), {}, first.factor()).value();
  CHECK(solve_frame(first, y).x == solve_frame(again, y).x);
  CHECK(Reconstructor::create(a, dct_box(0.2), {}, first.factor()).has_value());  // another lambda, the same rho
  recon::Plan other;
  other.rho = first.plan().rho * 2.0;
  const auto stale = Reconstructor::create(a, dct_box(0.1), other, first.factor());
  REQUIRE_FALSE(stale.has_value());
  CHECK(stale.error().code == ErrorCode::stale);
}

TEST_CASE("required_bytes is exact: a solver touches its last byte and none beyond") {
  const recon::Response a = some_response();
  const std::vector<float> y(20, 1.0F);
  for (const SolverSetting& setting : every_setting()) {
    CAPTURE(setting.name);
    recon::Plan plan = setting.plan;
    plan.max_reweighted = 2;
    const auto solver = Reconstructor::create(a, setting.objective, plan).value();
    const std::size_t bytes = solver.required_bytes();
    const recon::AlignedWorkspace memory(bytes + 256);
    std::memset(memory.span().data(), 0xA5, bytes + 256);
    std::vector<float> x(48), weights(20, 1.0F);
    weights[4] = weights[9] = 0.0F;
    const auto info = solver.solve(y, weights, memory.span().first(bytes), x);
    CHECK(info.health != recon::Health::invalid);
    for (std::size_t k = bytes; k < bytes + 256; ++k) CHECK(memory.span()[k] == std::byte{0xA5});
    bool touched = false;  // the last 64-byte piece is in use
    for (std::size_t k = bytes - 64; k < bytes; ++k) touched = touched || memory.span()[k] != std::byte{0xA5};
    CHECK(touched);
    CHECK(solver.solve(y, weights, memory.span().first(bytes - 64), x).health == recon::Health::invalid);
    CHECK(solver.solve(y, weights, memory.span().subspan(1, bytes), x).health == recon::Health::invalid);
  }
}

TEST_CASE("the same input gives the same bits, whatever was in the workspace before") {
  const recon::Response a = some_response();
  Random random(92);
  const auto y = to_float(random_vector(random, 20, 0, 3)), other = to_float(random_vector(random, 20, 0, 3));
  std::vector<float> weights(20, 1.0F);
  weights[3] = 0.0F;
  weights[11] = 0.5F;
  for (const SolverSetting& setting : every_setting()) {
    CAPTURE(setting.name);
    const auto solver = Reconstructor::create(a, setting.objective, setting.plan).value();
    const recon::AlignedWorkspace memory(solver.required_bytes());
    std::vector<float> first(48), second(48), between(48);
    std::memset(memory.span().data(), 0, memory.span().size());
    const auto before = solver.solve(y, weights, memory.span(), first);
    static_cast<void>(solver.solve(other, {}, memory.span(), between));
    std::memset(memory.span().data(), 0xFF, memory.span().size());
    const auto after = solver.solve(y, weights, memory.span(), second);
    CHECK(std::memcmp(first.data(), second.data(), 48 * sizeof(float)) == 0);
    CHECK(before.duality_gap == after.duality_gap);
    CHECK(before.objective == after.objective);
    CHECK(first != between);
  }
}

TEST_CASE("the gap is measured when asked for, and costs its memory only then") {
  const recon::Response a = some_response();
  const std::vector<float> y(20, 1.0F);
  for (SolverSetting setting : every_setting()) {
    CAPTURE(setting.name);
    const auto kind = setting.plan.solver;
    const bool has_gap = kind != recon::solver_named("tikhonov") && kind != recon::solver_named("tsvd") &&
                         kind != recon::solver_named("omp") &&
                         !(setting.objective.epsilon && setting.objective.constraint == recon::ConstraintKind::box);
    const auto with = Reconstructor::create(a, setting.objective, setting.plan).value();
    setting.plan.measure_gap = false;
    const auto without = Reconstructor::create(a, setting.objective, setting.plan).value();
    const SolvedFrame measured = solve_frame(with, y), plain = solve_frame(without, y);
    CHECK((measured.info.duality_gap >= 0.0) == has_gap);
    CHECK(plain.info.duality_gap == -1.0);
    CHECK(measured.x == plain.x);
    const bool by_gap = kind == recon::solver_named("fista") || kind == recon::solver_named("cp");
    CHECK((with.required_bytes() > without.required_bytes()) == (has_gap && !by_gap));  // those need it themselves
  }
}

TEST_CASE("a dark frame stays dark and quick: no subnormal numbers in the answer") {
  const recon::Response a = some_response();
  for (const SolverSetting& setting : every_setting()) {
    CAPTURE(setting.name);
    recon::Plan plan = setting.plan;
    plan.iterations = test::sanitized ? 200 : 2000;
    const auto solver = Reconstructor::create(a, setting.objective, plan).value();
    for (const float level : {0.0F, 1e-12F, 1e-25F, 1e-40F}) {
      const SolvedFrame frame = solve_frame(solver, std::vector<float>(20, level));
      CHECK(frame.info.health != recon::Health::invalid);
      // Direct methods answer subnormal samples in their own unit.
      const bool subnormal = setting.plan.solver->direct && level < std::numeric_limits<float>::min();
      for (const float v : frame.x) CHECK((v == 0.0F || std::isnormal(v) || (subnormal && std::isfinite(v))));
    }
  }
}

TEST_CASE("a solver can be moved and still owns its tables") {
  const recon::Response a = some_response();
  auto made = Reconstructor::create(a, dct_box(0.1), {});
  const std::vector<float> y(20, 1.0F);
  const auto before = solve_frame(*made, y).x;
  const Reconstructor moved = std::move(*made);
  CHECK(solve_frame(moved, y).x == before);
  CHECK(moved.table_bytes() > 0);
  CHECK(moved.operating_point().iterations == 100);
}
