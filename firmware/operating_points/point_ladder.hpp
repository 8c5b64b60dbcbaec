#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware/eye/ready_eye.hpp"
#include "firmware/operating_points/point_choice.hpp"
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
  void forget() noexcept override {
    for (const auto& solver : solvers_) solver->forget();
  }

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

struct StepSettings {
  /// A miss weighs as much as so many frames in time take back; a step down comes at `weight_down`. With 4 and 12:
  /// after three misses in a row, or where one frame in five is late for long.
  int miss_weight = 4;
  int weight_down = 12;
  std::int64_t calm_ns = 2'000'000'000;        ///< without a miss before a step up is tried ...
  int calm_frames = 20;                        ///< ... and so many frames in time
  std::int64_t most_calm_ns = 64'000'000'000;  ///< what calm grows to when steps up keep failing
};

/// When to go to a faster point and when back: pure, its time comes in. Rung 0 is the point that was chosen, each
/// further one is faster. A step up that has to be taken back doubles the calm that the next one waits for, and one
/// that holds as long as that calm resets it, so that a load that stays makes fewer and fewer attempts instead of
/// flapping.
class StepRule {
 public:
  explicit StepRule(std::size_t rungs, const StepSettings& settings = {}) noexcept
      : settings_(settings), rungs_(rungs), calm_ns_(settings.calm_ns) {}

  /// A frame that was solved on `rung` has been published at `now_ns`. One that was solved before the last step says
  /// nothing about the rung it was for.
  void published(std::size_t rung, bool late, std::int64_t now_ns) noexcept;

  [[nodiscard]] std::size_t rung() const noexcept { return rung_; }
  [[nodiscard]] std::uint64_t steps_down() const noexcept { return steps_down_; }
  [[nodiscard]] std::uint64_t steps_up() const noexcept { return steps_up_; }
  [[nodiscard]] std::uint64_t misses() const noexcept { return misses_; }

 private:
  void step_to(std::size_t rung, std::int64_t now_ns) noexcept;

  StepSettings settings_;
  std::size_t rungs_;
  std::size_t rung_ = 0;
  int weight_ = 0;   // of recent misses on this rung
  int in_time_ = 0;  // frames since the last miss or step
  std::int64_t calm_since_ns_ = 0;
  std::int64_t calm_ns_;  // that a step up waits for
  bool trying_ = false;   // the last step was up and has not held long enough yet
  bool begun_ = false;
  std::uint64_t steps_down_ = 0;
  std::uint64_t steps_up_ = 0;
  std::uint64_t misses_ = 0;
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
