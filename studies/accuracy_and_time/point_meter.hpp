#pragma once

#include <functional>
#include <vector>

#include "firmware/operating_points/measured_point.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "studies/accuracy_and_time/curve_eyes.hpp"
#include "studies/accuracy_and_time/evaluation_scenes.hpp"
#include "studies/accuracy_and_time/frame_times.hpp"

namespace compueye::firmware {

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
