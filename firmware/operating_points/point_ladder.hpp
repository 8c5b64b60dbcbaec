#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/eye/ready_eye.hpp"
#include "firmware/operating_points/point_choice.hpp"
#include "firmware/operating_points/step_rule.hpp"
#include "firmware/pipeline/frame_observer.hpp"
#include "firmware/pipeline/frame_solver.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The points of a choice, ready to be solved with: an eye for every curve among them and, for each rung, which eye it
/// is and with how many iterations. Points of one curve share its eye.
struct PointLadder {
  struct Rung {
    std::size_t eye = 0;
    recon::OperatingPoint point;
  };
  std::vector<ReadyEye> eyes;  ///< the first is the chosen point's
  std::vector<Rung> rungs;
};

/// `cache` as for ReadyEye::make(). Errors: those of ReadyEye::make().
[[nodiscard]] hal::Result<PointLadder> make_ladder(const Board& board, const LivingResponse& living, const Sweep& sweep,
                                                   const PointChoice& choice, const std::string& cache,
                                                   const recon::Progress& progress);

/// Solves every frame on the rung that is wanted at its beginning. All rungs were set up before; going from one to the
/// other costs nothing and allocates nothing.
class LadderSolver final : public FrameSolver {
 public:
  /// `ladder` must outlive the solver and is nobody else's to change while it lives.
  explicit LadderSolver(PointLadder& ladder);

  [[nodiscard]] int channels() const noexcept override { return solvers_.front()->channels(); }
  [[nodiscard]] hal::FrameFormat format() const noexcept override { return solvers_.front()->format(); }
  recon::FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                         std::span<float> x) noexcept override;

  /// From any thread; holds from the next frame on.
  void use(std::size_t rung) noexcept { wanted_.store(rung, std::memory_order_relaxed); }
  /// Which rung a solved frame says it is from; the number of rungs when from none.
  [[nodiscard]] std::size_t rung_of(const recon::OperatingPoint& point) const noexcept;
  [[nodiscard]] std::size_t rungs() const noexcept { return ladder_.rungs.size(); }

 private:
  PointLadder& ladder_;
  std::vector<std::unique_ptr<ReconstructorSolver>> solvers_;  // by eye
  std::atomic<std::size_t> wanted_{0};
};

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
