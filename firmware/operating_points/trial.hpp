#pragma once

#include <atomic>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/operating_points/deadline_choice.hpp"
#include "firmware/pipeline/correction.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// One corrected frame, taken before the run.
struct TrialFrame {
  std::vector<float> y;
  std::vector<float> weights;
};

/// Starts the source, takes one frame, stops it. A frame that the correction would drop is an error (mismatch) that
/// says what is wrong with it: a simulated eye shows the same scene for ever, so the run would deliver nothing. Error
/// interrupted when `stop` becomes true before the frame has come.
[[nodiscard]] hal::Result<TrialFrame> take_trial_frame(const Board& board, const CorrectionSettings& settings,
                                                       hal::SampleSource& source, hal::Clock& clock,
                                                       const std::atomic<bool>& stop);

/// Times a few real solves of the trial frame and leaves `eye` with as many iterations as the deadline allows.
[[nodiscard]] hal::Result<DeadlineChoice> fit_deadline(double deadline_ms, double period_ms, const TrialFrame& frame,
                                                       ReadyEye& eye, const hal::Clock& clock);

}  // namespace compueye::firmware
