#include "firmware/pipeline/reconstructor_solver.hpp"

#include <algorithm>
#include <cstddef>

namespace compueye::firmware {

ReconstructorSolver::ReconstructorSolver(const recon::Reconstructor& reconstructor)
    : reconstructor_(reconstructor), workspace_(reconstructor.required_bytes()) {
  // Touched here, so that the first frame does not pay for the page faults.
  std::ranges::fill(workspace_.span(), std::byte{0});
}

recon::FrameInfo ReconstructorSolver::solve(std::span<const float> y, std::span<const float> weights,
                                            std::span<float> x) noexcept {
  return reconstructor_.solve(y, weights, workspace_.span(), x);
}

}  // namespace compueye::firmware
