#include "firmware/operating_points/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "firmware/pipeline/reconstructor_solver.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

hal::Result<void> unusable(const Board& board, const Correction& correction, const CorrectionReport& report) {
  const int seeing = correction.seeing_channels();
  if (report.saturated > 0) {
    return hal::fail(ErrorCode::mismatch, board.place("sensor", "full_scale"),
                     fmt::format("{} of {} seeing channels saturate in front of this scene, and max_missing_share "
                                 "lets at most {} be missing, so every frame would be dropped; expected a full_scale "
                                 "above {} or a darker scene",
                                 report.saturated, seeing, static_cast<int>(board.sensor.max_missing_share * seeing),
                                 board.sensor.full_scale));
  }
  return hal::fail(ErrorCode::mismatch, board.place("sensor", "max_missing_share"),
                   fmt::format("the first frame lacks {} of {} seeing channels, so every frame would be dropped",
                               report.masked, seeing));
}

/// In short reads, so that a stop request is noticed even at a frame an hour.
hal::Result<hal::SampleBlock> first_block(const Board& board, hal::SampleSource& source, hal::Clock& clock,
                                          const std::atomic<bool>& stop) {
  constexpr std::int64_t slice_ns = 100'000'000, patience_ns = 2'000'000'000;
  const auto period_ns = static_cast<std::int64_t>(1e9 / board.source.frame_rate_hz);
  const std::int64_t give_up_ns = clock.now_ns() + 2 * period_ns + patience_ns;
  for (;;) {
    if (stop.load(std::memory_order_relaxed)) {
      return hal::fail(ErrorCode::interrupted, board.name, "stopped before the first frame");
    }
    auto block = source.read(clock.now_ns() + slice_ns);
    if (block || block.error().code != ErrorCode::timeout) return block;
    if (clock.now_ns() >= give_up_ns) {
      return hal::fail(ErrorCode::timeout, source.describe().serial, "no frame came; is the eye powered?");
    }
  }
}

}  // namespace

hal::Result<TrialFrame> take_trial_frame(const Board& board, const CorrectionSettings& settings,
                                         hal::SampleSource& source, hal::Clock& clock, const std::atomic<bool>& stop) {
  auto correction = Correction::create(settings, source.describe());
  if (!correction) return tl::unexpected(std::move(correction.error()));
  if (auto started = source.start(); !started) return tl::unexpected(std::move(started.error()));
  const auto block = first_block(board, source, clock, stop);
  if (!block) {
    source.stop();
    return tl::unexpected(block.error());
  }
  const auto channels = static_cast<std::size_t>(source.describe().channels);
  TrialFrame frame{std::vector<float>(channels), std::vector<float>(channels)};
  const CorrectionReport report = correction->apply(*block, frame.y, frame.weights);
  source.stop();
  if (report.usable) return frame;
  return unusable(board, *correction, report).map([] { return TrialFrame{}; });
}

hal::Result<DeadlineChoice> fit_deadline(double deadline_ms, double period_ms, const TrialFrame& frame, ReadyEye& eye,
                                         const hal::Clock& clock) {
  const int most = eye.reconstructor().operating_point().iterations;
  std::vector<float> picture(static_cast<std::size_t>(eye.reconstructor().pixels()));
  std::unique_ptr<ReconstructorSolver> solver;
  int solver_iterations = 0;
  const auto solve_ns = [&](int iterations) -> hal::Result<std::int64_t> {
    if (iterations != solver_iterations) {
      if (auto set = eye.set_iterations(iterations); !set) return tl::unexpected(std::move(set.error()));
      solver = std::make_unique<ReconstructorSolver>(eye.reconstructor());
      solver_iterations = iterations;
    }
    const std::int64_t begin_ns = clock.now_ns();
    static_cast<void>(solver->solve(frame.y, frame.weights, picture));
    return clock.now_ns() - begin_ns;
  };
  const auto time = measure_solve_time(solve_ns, most);
  if (!time) return tl::unexpected(time.error());
  const DeadlineChoice choice = choose_iterations(deadline_ms, period_ms, *time, most);
  // A direct solver has nothing to leave out: its one step is what it is.
  const recon::SolverKind kind = eye.reconstructor().plan().solver;
  if (kind == recon::SolverKind::tikhonov || kind == recon::SolverKind::tsvd) return choice;
  return eye.set_iterations(choice.iterations).map([&] { return choice; });
}

}  // namespace compueye::firmware
