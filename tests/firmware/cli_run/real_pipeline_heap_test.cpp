#include <doctest/doctest.h>

#include <atomic>

#include "firmware/app/commands/frame_keeper.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"
#include "recon/solver_list.hpp"
#include "tests/memory/allocation_counter.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::tests::heap_use_of_process;
using compueye::tests::HeapUse;

namespace {

/// Counts from the first published frame on: by then every thread is past its start, in which a sanitizer's runtime
/// uses the heap for itself.
class CountingObserver final : public FrameObserver {
 public:
  explicit CountingObserver(FrameKeeper& keeper) : keeper_(keeper) {}
  HeapUse used;
  void published(const PublishedFrame& frame) noexcept override {
    keeper_.published(frame);
    if (frame.delivered == 1) before_ = heap_use_of_process();
    used = heap_use_of_process() - before_;
  }

 private:
  FrameKeeper& keeper_;
  HeapUse before_;
};

/// Takes every frame and keeps none.
class NullSink final : public hal::FrameSink {
 public:
  hal::Result<void> open(hal::FrameFormat) override { return {}; }
  hal::Result<void> write(const hal::Frame&) override { return {}; }
  hal::Result<void> close() override { return {}; }
};

}  // namespace

TEST_CASE("the whole runtime, with the simulated eye and the real solver, does not use the heap while frames come") {
  auto board = load_board(compueye::test::source_path("boards/sim-8x8"));
  REQUIRE(board.has_value());
  board->sensor.dead = {5, 9};
  for (const recon::SolverKind solver_kind : {recon::solver_named("admm"), recon::solver_named("tikhonov")}) {
    board->plan.solver = solver_kind;
    if (solver_kind == recon::solver_named("tikhonov")) board->objective.constraint = recon::ConstraintKind::none;
    board->plan.iterations = 20;
    const auto eye = ReadyEye::make(*board, {}, {});
    REQUIRE_MESSAGE(eye.has_value(), eye.error().text());
    hal::MonotonicClock clock;
    auto settings = simulated_eye_settings(*board, choose_scene(*board, {}).value(), 1);
    // A frame that is lost on the way and a channel that dies meanwhile belong to the frame path too.
    settings.faults.lost_frames = {20, 21};
    settings.faults.invalid_channels.push_back({30, 15});
    const auto simulated = sim::SimulatedEye::create(std::move(settings), clock);
    REQUIRE(simulated.has_value());
    ReconstructorSolver solver(eye->reconstructor());
    FrameKeeper keeper(solver.format(), 0, 4096);
    CountingObserver observer(keeper);
    NullSink sink;
    PipelineSettings pipeline_settings;
    pipeline_settings.pacing = Pacing::every_frame;
    pipeline_settings.frames = 60;
    pipeline_settings.device_clock = DeviceClock::free_running;
    pipeline_settings.correction = correction_settings(*board, eye->sees());
    auto pipeline = Pipeline::create(pipeline_settings, **simulated, solver, sink, clock, &observer);
    REQUIRE_MESSAGE(pipeline.has_value(), pipeline.error().text());
    const std::atomic<bool> stop{false};
    const RunSummary summary = pipeline->run(stop);
    CHECK(summary.frames.delivered == 60);
    CHECK(summary.frames.drops(hal::DropReason::transport_gap) == 2);
    CHECK(summary.masked_max == 3);
    CHECK(observer.used.allocations == 0);
    CHECK(observer.used.frees == 0);
  }
}
