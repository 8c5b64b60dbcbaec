#include "firmware/pipeline/reconstructor_solver.hpp"

#include <cstring>

namespace compueye::firmware {

ReconstructorSolver::ReconstructorSolver(const recon::Reconstructor& reconstructor)
    : reconstructor_(reconstructor),
      bytes_(reconstructor.required_bytes()),
      workspace_(static_cast<std::byte*>(::operator new(bytes_, alignment))) {
  // Touched here, so that the first frame does not pay for the page faults.
  std::memset(workspace_.get(), 0, bytes_);
}

recon::FrameInfo ReconstructorSolver::solve(std::span<const float> y, std::span<const float> weights,
                                            std::span<float> x) noexcept {
  return reconstructor_.solve(y, weights, {workspace_.get(), bytes_}, x);
}

}  // namespace compueye::firmware
