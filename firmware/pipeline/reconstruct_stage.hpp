#pragma once

#include <cstdint>

#include "firmware/pipeline/block_queue.hpp"
#include "firmware/pipeline/frame_slots.hpp"
#include "firmware/pipeline/frame_solver.hpp"
#include "firmware/pipeline/run_control.hpp"
#include "firmware/pipeline/stage_beat.hpp"
#include "firmware/pipeline/time_histogram.hpp"
#include "hal/accounting.hpp"
#include "hal/clock.hpp"

namespace compueye::firmware {

/// Solves one frame after the other. It waits for the sink before it takes its next samples, so that a slow sink costs
/// waiting samples (superseded) rather than solved pictures, and those samples are fresh when it goes on.
class ReconstructStage {
 public:
  ReconstructStage(FrameSolver& solver, hal::Clock& clock, RunControl& control, BlockQueue<CorrectedSlot>& in,
                   BlockQueue<PictureSlot>& out, StageBeat& beat) noexcept
      : solver_(solver), clock_(clock), control_(control), in_(in), out_(out), beat_(beat) {}

  void run() noexcept;

  // After the thread was joined:
  [[nodiscard]] hal::FrameAccount account() const noexcept;
  [[nodiscard]] TimeStatistics times() const noexcept { return times_.statistics(); }
  [[nodiscard]] std::uint64_t converged() const noexcept { return converged_; }
  [[nodiscard]] std::uint64_t budget_used() const noexcept { return budget_used_; }

 private:
  void take(CorrectedSlot& corrected, PictureSlot& picture) noexcept;

  FrameSolver& solver_;
  hal::Clock& clock_;
  RunControl& control_;
  BlockQueue<CorrectedSlot>& in_;
  BlockQueue<PictureSlot>& out_;
  StageBeat& beat_;

  hal::FrameAccount own_;
  std::uint64_t pushed_ = 0;
  TimeHistogram times_;
  std::uint64_t converged_ = 0;
  std::uint64_t budget_used_ = 0;
};

}  // namespace compueye::firmware
