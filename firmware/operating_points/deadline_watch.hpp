#pragma once

#include <cstdint>
#include <vector>

#include "firmware/operating_points/ladder_solver.hpp"
#include "firmware/operating_points/step_rule.hpp"
#include "firmware/pipeline/frame_observer.hpp"
#include "hal/clock.hpp"

namespace compueye::firmware {

/// Tells the solver to step down when published frames are late and back up when they are not, and hands every frame on
/// to another observer. Allocates nothing after construction.
class DeadlineWatch final : public FrameObserver {
 public:
  /// All must outlive the watch.
  DeadlineWatch(LadderSolver& solver, const hal::Clock& clock, FrameObserver& next, const StepSettings& settings = {})
      : solver_(solver), clock_(clock), next_(next), rule_(solver.rungs(), settings), frames_(solver.rungs(), 0) {}

  void published(const PublishedFrame& frame) noexcept override {
    const std::size_t rung = solver_.rung_of(frame.info.point);
    if (rung < frames_.size()) ++frames_[rung];
    rule_.published(rung, frame.late, clock_.now_ns());
    solver_.use(rule_.rung());
    next_.published(frame);
  }

  // After the run:
  [[nodiscard]] const StepRule& rule() const noexcept { return rule_; }
  [[nodiscard]] const std::vector<std::uint64_t>& frames() const noexcept { return frames_; }  ///< delivered, by rung

 private:
  LadderSolver& solver_;
  const hal::Clock& clock_;
  FrameObserver& next_;
  StepRule rule_;
  std::vector<std::uint64_t> frames_;
};

}  // namespace compueye::firmware
