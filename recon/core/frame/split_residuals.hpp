#pragma once

#include <cstddef>

#include "recon/core/frame/frame_info.hpp"

namespace compueye::recon::core {

/// Squares over all copies of x after an iteration of a splitting method: how far they are from x, how far they moved,
/// and the sizes to compare those with.
struct SplitResiduals {
  double apart = 0.0, moved = 0.0;
  double of_x = 0.0, of_copies = 0.0, of_duals = 0.0;

  /// Adds one copy: x as the quadratic step left it, z what its proximal map made of it, z before and the scaled dual.
  template <class T>
  void add(const T* x, const T* z, const T* before, const T* dual, std::size_t n) noexcept;

  /// Fills in both residuals, the iterations and the health: converged when both are below 1e-3. They are those of Boyd
  /// et al. 2011, section 3.3.1, relative to the sizes named there, or to a hundredth of the other size where that is
  /// more: at an x that is exactly zero, or where constraint and l1 term are idle, rounding would never count as
  /// converged.
  void judge(int iterations, FrameInfo& info) const noexcept;
};

}  // namespace compueye::recon::core
