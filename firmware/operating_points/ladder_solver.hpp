#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "firmware/operating_points/point_ladder.hpp"
#include "firmware/pipeline/frame_solver.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"

namespace compueye::firmware {

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

}  // namespace compueye::firmware
