#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "firmware/operating_points/point_ladder.hpp"
#include "tests/firmware/pareto/some_sweep.hpp"
#include "tests/memory/allocation_counter.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::some_sweep;

namespace {

struct Counting final : FrameObserver {
  int seen = 0;
  void published(const PublishedFrame&) noexcept override { ++seen; }
};

Board board_8x8() {
  auto board = load_board(compueye::test::source_path("boards/sim-8x8"));
  REQUIRE(board.has_value());
  return *board;
}

/// 40 and 10 iterations in the DCT, 5 in total variation.
PointLadder some_ladder(const Board& board, const LivingResponse& living) {
  const Sweep sweep = some_sweep({{40, 4, 0.1}, {10, 1, 0.2}, {5, 0.5, 0.3, recon::BasisKind::tv}});
  PointChoice choice;
  choice.ladder = {0, 1, 2};
  auto ladder = make_ladder(board, living, sweep, choice, {}, {});
  REQUIRE_MESSAGE(ladder.has_value(), ladder.error().text());
  return std::move(*ladder);
}

}  // namespace

TEST_CASE("a ladder has an eye a curve, and a frame of a rung has the bits of that point alone") {
  const Board board = board_8x8();
  const auto living = living_response(board, recon::Progress{});
  REQUIRE(living.has_value());
  PointLadder ladder = some_ladder(board, *living);
  CHECK(ladder.eyes.size() == 2);
  REQUIRE(ladder.rungs.size() == 3);
  LadderSolver solver(ladder);
  const std::vector<float> y(64, 0.7F), weights(64, 1.0F);
  std::vector<float> x(256), alone(256);
  for (const std::size_t rung : {0U, 1U, 2U, 1U, 0U, 2U}) {
    CAPTURE(rung);
    solver.use(rung);
    const recon::FrameInfo info = solver.solve(y, weights, x);
    CHECK(solver.rung_of(info.point) == rung);
    Board one = board;
    one.plan.iterations = ladder.rungs[rung].point.iterations;
    one.objective.basis = ladder.rungs[rung].point.basis;
    auto eye = ReadyEye::make(one, *living, {}, {});
    REQUIRE(eye.has_value());
    ReconstructorSolver single(eye->reconstructor());
    static_cast<void>(single.solve(y, weights, alone));
    CHECK(x == alone);
  }
  CHECK(solver.rung_of({}) == solver.rungs());
}

TEST_CASE("late frames step down, frames in time step up, and no step allocates") {
  const Board board = board_8x8();
  const auto living = living_response(board, recon::Progress{});
  REQUIRE(living.has_value());
  PointLadder ladder = some_ladder(board, *living);
  LadderSolver solver(ladder);
  hal::VirtualClock clock;
  Counting next;
  DeadlineWatch watch(solver, clock, next);
  const std::vector<float> y(64, 0.7F), weights(64, 1.0F);
  std::vector<float> x(256);
  constexpr int frames = 1000;
  const std::uint64_t before = tests::heap_use_of_this_thread().calls();
  for (int i = 0; i < frames; ++i) {
    clock.advance(20'000'000);
    const recon::FrameInfo info = solver.solve(y, weights, x);
    const hal::Frame frame{x, solver.format(), static_cast<std::uint64_t>(i), 0};
    // A burst near the beginning, during which only total variation is quick enough.
    const bool late = i >= 100 && i < 300 && info.point.basis != recon::BasisKind::tv;
    watch.published({frame, info, y, weights, 0, 0, late, static_cast<std::uint64_t>(i) + 1});
  }
  CHECK(tests::heap_use_of_this_thread().calls() == before);
  CHECK(next.seen == frames);
  CHECK(watch.rule().rung() == 0);
  CHECK(watch.rule().steps_down() >= 2);
  CHECK(watch.rule().steps_up() == watch.rule().steps_down());
  std::uint64_t delivered = 0;
  for (const std::uint64_t count : watch.frames()) {
    CHECK(count > 0);
    delivered += count;
  }
  CHECK(delivered == frames);
}
