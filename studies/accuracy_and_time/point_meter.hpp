#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/eye/ready_eye.hpp"
#include "firmware/operating_points/measured_points.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "studies/accuracy_and_time/scenes.hpp"

namespace compueye::firmware {

/// One curve set up for every noise level, its factor made once and kept beside the board.
struct CurveEyes {
  std::vector<recon::Reconstructor> by_level;
  std::vector<double> lambda;  ///< by rule
  std::vector<std::string> notes;
};

/// Errors: those of ReadyEye::make().
[[nodiscard]] hal::Result<CurveEyes> set_up_curve(const Board& board, const LivingResponse& living, const Curve& curve,
                                                  const std::vector<NoiseLevel>& levels,
                                                  const recon::Progress& progress);

/// The times of single frames, every one kept, so that percentiles far out are exact.
class FrameTimes {
 public:
  /// `cpu_ns` is the processor time that the frame took of the process.
  void add(std::int64_t ns, std::int64_t cpu_ns = 0) {
    ns_.push_back(ns);
    total_ns_ += ns;
    total_cpu_ns_ += cpu_ns;
  }
  [[nodiscard]] std::size_t count() const noexcept { return ns_.size(); }
  /// By nearest rank, in ms; NaN without frames. `per_mille` 500 is the median. With fewer than 1000 frames 999 is the
  /// slowest of them, and the frames must be told beside it.
  [[nodiscard]] double percentile_ms(std::uint64_t per_mille) const;

  [[nodiscard]] std::int64_t total_ns() const noexcept { return total_ns_; }
  [[nodiscard]] std::int64_t total_cpu_ns() const noexcept { return total_cpu_ns_; }

 private:
  std::vector<std::int64_t> ns_;
  std::int64_t total_ns_ = 0;
  std::int64_t total_cpu_ns_ = 0;
};

/// How many frames are timed at most, and for how long.
struct TimingLimit {
  std::size_t frames = 0;
  std::int64_t ns = 0;  ///< five frames are timed all the same
};

/// Measures points on the frames of every noise level. Pictures are judged first and frames timed afterwards, one right
/// after the other as in a run.
class PointMeter {
 public:
  using GoOn = std::function<bool()>;  ///< asked before every frame; false ends the work with error interrupted

  /// Everything must outlive the meter. `frames` has the sequences of every scene, by level.
  PointMeter(const std::vector<EvaluationScene>& scenes, const std::vector<NoiseLevel>& levels,
             const std::vector<std::vector<FrameSequence>>& frames, const hal::Clock& clock, GoOn go_on)
      : scenes_(scenes), levels_(levels), frames_(frames), clock_(clock), go_on_(std::move(go_on)) {}

  /// Quality of the last picture of every sequence, each begun cold, and bytes; no times. Leaves every eye with these
  /// iterations. Errors: out_of_range (a frame that cannot be solved), interrupted.
  [[nodiscard]] hal::Result<MeasuredPoint> judge(const Curve& curve, CurveEyes& eyes, int iterations) const;

  /// Times frames of the first level, sequence after sequence, after one that warms the caches. Error interrupted, with
  /// the times so far added. Wall time is what a deadline sees; the processor time beside it tells whether the machine
  /// was busy otherwise.
  [[nodiscard]] hal::Result<void> time(const recon::Reconstructor& reconstructor, const TimingLimit& limit,
                                       FrameTimes& times) const;

 private:
  const std::vector<EvaluationScene>& scenes_;
  const std::vector<NoiseLevel>& levels_;
  const std::vector<std::vector<FrameSequence>>& frames_;
  const hal::Clock& clock_;
  GoOn go_on_;
};

}  // namespace compueye::firmware
