#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include "firmware/pipeline/frame_solver.hpp"
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

 private:
  static constexpr std::align_val_t alignment{64};
  struct Release {
    void operator()(std::byte* memory) const noexcept { ::operator delete(memory, alignment); }
  };

  const recon::Reconstructor& reconstructor_;
  std::size_t bytes_;
  std::unique_ptr<std::byte, Release> workspace_;
};

}  // namespace compueye::firmware
