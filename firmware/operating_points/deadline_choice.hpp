#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/pipeline/correction.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// A frame of `iterations` takes fixed_ns + iterations * per_iteration_ns to solve on this machine.
struct SolveTime {
  double fixed_ns = 0.0;
  double per_iteration_ns = 0.0;
  [[nodiscard]] double of(int iterations) const noexcept { return fixed_ns + iterations * per_iteration_ns; }
};

/// How many iterations a deadline leaves room for, and why.
struct DeadlineChoice {
  double deadline_ms = 0.0;
  int most_iterations = 0;   ///< what was asked for without a deadline
  int iterations = 0;        ///< chosen, least_iterations .. most_iterations
  bool fits = false;         ///< false: not even the fewest iterations do
  bool by_rate = false;      ///< one iteration more would be slower than frames come, whatever the deadline
  double solve_ms = 0.0;     ///< predicted for `iterations`
  double age_ms = 0.0;       ///< predicted for `iterations`: exposure, waiting and solving
  double least_ms = 0.0;     ///< the shortest deadline that the fewest iterations meet
  double for_most_ms = 0.0;  ///< the shortest deadline that most_iterations meet, if frames come no faster
  /// "deadline 100 ms: 31 of 60 iterations, ..."
  [[nodiscard]] std::string sentence() const;
};

/// Share of the deadline that the prediction may use up: the rest is for the sink and for a machine that is busy.
inline constexpr double deadline_share = 0.8;

/// Where nothing meets the deadline, accuracy chooses among pictures that are at most so many times as old as those of
/// the fastest.
inline constexpr double nearly_as_fast = 1.25;

/// With fewer iterations a picture can be worse than the conventional eye's (at two an 80x80 eye has 0.8 times its
/// NMSE, at one 1.6 times), so no deadline is short enough to ask for them.
inline constexpr int least_iterations = 3;

/// The age of a frame: its exposure (one frame period), its solution, and, when the solver is slower than the frames
/// come, up to one period that the newest frame waited for the solver.
[[nodiscard]] double predicted_age_ms(double solve_ms, double period_ms) noexcept;

/// The largest number of iterations whose predicted age stays within deadline_share of the deadline and that takes no
/// longer than a frame period, but no fewer than least_iterations (or all, where those are fewer). Where those are too
/// many already, as many as make pictures hardly older.
[[nodiscard]] DeadlineChoice choose_iterations(double deadline_ms, double period_ms, const SolveTime& time,
                                               int most_iterations);

/// Times real solves: `solve_ns(iterations)` solves one frame and says how long it took.
using TimedSolve = std::function<hal::Result<std::int64_t>(int iterations)>;
[[nodiscard]] hal::Result<SolveTime> measure_solve_time(const TimedSolve& solve_ns, int most_iterations);

/// One corrected frame, taken before the run.
struct TrialFrame {
  std::vector<float> y;
  std::vector<float> weights;
  int taken = 1;       ///< frames that were taken for it, itself the last of them where it is `wanted`
  bool wanted = true;  ///< it is what was looked for
};
using TrialWanted = std::function<bool(const TrialFrame&)>;
/// So many frames, of two seconds, may go by in search of one that is wanted.
inline constexpr int most_trial_frames = 16;

/// Starts the source, takes one frame, stops it. With `wanted` it goes on until one is that, or returns the last sound
/// one. Where the correction would drop all that came, that is an error (mismatch) that says what is wrong with the
/// first: a simulated eye shows the same scene for ever, so the run would deliver nothing. Error interrupted when
/// `stop` becomes true before a frame has come.
[[nodiscard]] hal::Result<TrialFrame> take_trial_frame(const Board& board, const CorrectionSettings& settings,
                                                       hal::SampleSource& source, hal::Clock& clock,
                                                       const std::atomic<bool>& stop, const TrialWanted& wanted = {});

/// Times a few real solves of the trial frame and leaves `eye` with as many iterations as the deadline allows.
[[nodiscard]] hal::Result<DeadlineChoice> fit_deadline(double deadline_ms, double period_ms, const TrialFrame& frame,
                                                       ReadyEye& eye, const hal::Clock& clock);

}  // namespace compueye::firmware
