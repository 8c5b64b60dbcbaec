#pragma once

#include <span>

#include "recon/aligned_workspace.hpp"
#include "recon/core/frame/frame_info.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// Whether a response can be that of the eye a frame came from. Multiples of what noise explains, which is
/// sigma sqrt(channels used).
struct ResponseFit {
  double residual = 0.0;  ///< of the delivered picture; large too where a solver had few iterations
  double least = 0.0;     ///< of any picture at all (core::LeastResidual): at most one where only noise is there

  /// Three, because sigma is known to a third or so.
  [[nodiscard]] bool misfit() const noexcept { return least > 3.0; }
};

/// Tells of frames how a response fits them; memory is taken once.
class ResponseFitter {
 public:
  /// `reconstructor` must outlive it. `sigma`: noise of a sample of weight one, in units of y, >= 0.
  ResponseFitter(const Reconstructor& reconstructor, double sigma)
      : reconstructor_(reconstructor), sigma_(sigma), workspace_(reconstructor.least_residual_bytes()) {}

  /// Of a frame that was solved: one A and one A'. Does not allocate.
  [[nodiscard]] ResponseFit fit(const FrameInfo& info, std::span<const float> y, std::span<const float> weights,
                                std::span<const float> x) const noexcept;

 private:
  const Reconstructor& reconstructor_;
  double sigma_;
  AlignedWorkspace workspace_;
};

}  // namespace compueye::recon
