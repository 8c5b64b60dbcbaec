#include "firmware/operating_points/deadline_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "firmware/pipeline/reconstructor_solver.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

constexpr double ns_per_ms = 1e6;
constexpr std::size_t repeats = 5;
/// A second of trials is enough patience for one point of the line.
constexpr std::int64_t patience_ns = 1'000'000'000;

/// Median of some trials after one that warms the caches.
hal::Result<double> median_ns(const TimedSolve& solve_ns, int iterations) {
  TRY(solve_ns(iterations));
  std::array<std::int64_t, repeats> times{};
  std::size_t count = 0;
  for (std::int64_t spent = 0; count < repeats && (count == 0 || spent < patience_ns); ++count) {
    times[count] = TRY(solve_ns(iterations));
    spent += times[count];
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(times.begin(), middle, times.begin() + static_cast<std::ptrdiff_t>(count));
  return static_cast<double>(*middle);
}

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
  constexpr std::int64_t slice_ns = 100'000'000, grace_ns = 2'000'000'000;
  const auto period_ns = static_cast<std::int64_t>(1e9 / board.source.frame_rate_hz);
  const std::int64_t give_up_ns = clock.now_ns() + 2 * period_ns + grace_ns;
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

hal::Result<TrialFrame> search_frame(const Board& board, hal::SampleSource& source, hal::Clock& clock,
                                     const std::atomic<bool>& stop, const TrialWanted& wanted, Correction& correction) {
  constexpr std::int64_t enough_ns = 2'000'000'000;
  const auto channels = static_cast<std::size_t>(source.describe().channels);
  const int most = wanted ? most_trial_frames : 1;
  TrialFrame frame{std::vector<float>(channels), std::vector<float>(channels), 0, false}, sound;
  std::optional<CorrectionReport> fault;
  std::int64_t began_ns = 0;
  while (frame.taken < most && (frame.taken == 0 || clock.now_ns() - began_ns < enough_ns)) {
    const auto block = first_block(board, source, clock, stop);
    // What came before is something to go on with.
    if (!block && (frame.taken == 0 || block.error().code == ErrorCode::interrupted)) {
      return tl::unexpected(block.error());
    }
    if (!block) break;
    if (frame.taken++ == 0) began_ns = clock.now_ns();
    const CorrectionReport report = correction.apply(*block, frame.y, frame.weights);
    if (!report.usable) {
      if (!fault) fault = report;
      continue;
    }
    frame.wanted = !wanted || wanted(frame);
    if (frame.wanted) return frame;
    sound = frame;
  }
  if (sound.y.empty()) TRY(unusable(board, correction, *fault));
  sound.taken = frame.taken;
  return sound;
}

}  // namespace

double predicted_age_ms(double solve_ms, double period_ms) noexcept {
  return period_ms + solve_ms + (solve_ms > period_ms ? period_ms : 0.0);
}

hal::Result<SolveTime> measure_solve_time(const TimedSolve& solve_ns, int most_iterations) {
  const double most_ns = TRY(median_ns(solve_ns, most_iterations));
  const double even = most_ns / most_iterations;
  const int few_iterations = std::max(1, most_iterations / 8);
  if (few_iterations == most_iterations) return SolveTime{0.0, even};
  const double few_ns = TRY(median_ns(solve_ns, few_iterations));
  // A disturbed trial must not make iterations free or the rest negative.
  const double slope = std::clamp((most_ns - few_ns) / (most_iterations - few_iterations), 0.5 * even, even);
  return SolveTime{most_ns - slope * most_iterations, slope};
}

DeadlineChoice choose_iterations(double deadline_ms, double period_ms, const SolveTime& time, int most_iterations) {
  const auto solve_ms = [&](int iterations) { return time.of(iterations) / ns_per_ms; };
  const auto within = [&](int iterations, double age_ms) {
    return solve_ms(iterations) <= period_ms && predicted_age_ms(solve_ms(iterations), period_ms) <= age_ms;
  };
  const auto fits = [&](int iterations) { return within(iterations, deadline_share * deadline_ms); };
  const int least = std::min(least_iterations, most_iterations);
  const double allowed_ms =
      fits(least) ? deadline_share * deadline_ms : nearly_as_fast * predicted_age_ms(solve_ms(least), period_ms);
  int iterations = most_iterations;
  while (iterations > least && !within(iterations, allowed_ms)) --iterations;
  DeadlineChoice choice;
  choice.deadline_ms = deadline_ms;
  choice.most_iterations = most_iterations;
  choice.iterations = iterations;
  choice.fits = fits(iterations);
  choice.solve_ms = solve_ms(iterations);
  choice.age_ms = predicted_age_ms(choice.solve_ms, period_ms);
  choice.by_rate = choice.fits && iterations < most_iterations && solve_ms(iterations + 1) > period_ms;
  choice.least_ms = predicted_age_ms(solve_ms(least), period_ms) / deadline_share;
  choice.for_most_ms = predicted_age_ms(solve_ms(most_iterations), period_ms) / deadline_share;
  return choice;
}

std::string DeadlineChoice::sentence() const {
  const auto ms = [](double value) { return significant(value, 3) + " ms"; };
  if (!fits) {
    return fmt::format(
        "the deadline of {} cannot be kept at this frame rate: with {} iterations a picture is already about {} old "
        "(exposure and {} of solving); running with them all the same, since fewer would hardly be quicker, and at "
        "worst no better than the conventional "
        "eye, so expect late pictures; {} is the shortest deadline this machine can promise for this board, "
        "{} "
        "the shortest for all {} iterations",
        ms(deadline_ms), iterations, ms(age_ms), ms(solve_ms), ms(least_ms), ms(for_most_ms), most_iterations);
  }
  if (iterations == most_iterations) {
    return fmt::format("the deadline of {} leaves room for all {} iterations: {} of solving, pictures about {} old",
                       ms(deadline_ms), iterations, ms(solve_ms), ms(age_ms));
  }
  return fmt::format(
      "the {} leaves room for {} of {} iterations: {} of solving, pictures about {} old; all {} need {}a deadline of "
      "{}",
      by_rate ? "frame rate" : "deadline of " + ms(deadline_ms), iterations, most_iterations, ms(solve_ms), ms(age_ms),
      most_iterations, by_rate ? "slower frames and " : "", ms(for_most_ms));
}

hal::Result<TrialFrame> take_trial_frame(const Board& board, const CorrectionSettings& settings,
                                         hal::SampleSource& source, hal::Clock& clock, const std::atomic<bool>& stop,
                                         const TrialWanted& wanted) {
  Correction correction = TRY(Correction::create(settings, source.describe()));
  TRY(source.start());
  auto frame = search_frame(board, source, clock, stop, wanted, correction);
  source.stop();
  return frame;
}

hal::Result<DeadlineChoice> fit_deadline(double deadline_ms, double period_ms, const TrialFrame& frame, ReadyEye& eye,
                                         const hal::Clock& clock) {
  const int most = eye.reconstructor().operating_point().iterations;
  std::vector<float> picture(static_cast<std::size_t>(eye.reconstructor().pixels()));
  std::unique_ptr<ReconstructorSolver> solver;
  int solver_iterations = 0;
  const auto solve_ns = [&](int iterations) -> hal::Result<std::int64_t> {
    if (iterations != solver_iterations) {
      TRY(eye.set_iterations(iterations));
      solver = std::make_unique<ReconstructorSolver>(eye.reconstructor());
      solver_iterations = iterations;
    }
    const std::int64_t begin_ns = clock.now_ns();
    static_cast<void>(solver->solve(frame.y, frame.weights, picture));
    return clock.now_ns() - begin_ns;
  };
  const SolveTime time = TRY(measure_solve_time(solve_ns, most));
  const DeadlineChoice choice = choose_iterations(deadline_ms, period_ms, time, most);
  // A direct solver has nothing to leave out: its one step is what it is.
  if (eye.reconstructor().plan().solver->direct) return choice;
  TRY(eye.set_iterations(choice.iterations));
  return choice;
}

}  // namespace compueye::firmware
