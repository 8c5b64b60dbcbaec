#pragma once

#include <span>

#include "firmware/pipeline/frame_solver.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// recon::Reconstructor as the pipeline's solver, with a workspace of its own.
class ReconstructorSolver final : public FrameSolver {
 public:
  /// `reconstructor` must outlive this object; several solvers may share one.
  explicit ReconstructorSolver(const recon::Reconstructor& reconstructor);

  [[nodiscard]] int channels() const noexcept override { return reconstructor_.channels(); }
  [[nodiscard]] hal::FrameFormat format() const noexcept override {
    return {reconstructor_.image_rows(), reconstructor_.image_cols()};
  }
  recon::FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                         std::span<float> x) noexcept override;
  void forget() noexcept override { reconstructor_.forget_last_frame(workspace_.span()); }

 private:
  const recon::Reconstructor& reconstructor_;
  recon::AlignedWorkspace workspace_;
};

}  // namespace compueye::firmware
