#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/weighted_dual_step.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// Whether a frame may go on from where the last one in this workspace ended, and what has to be kept to tell. Nothing
/// is kept or allowed unless `wanted`.
///
/// The change of the samples is weighed as the method weighs its residuals: with d = y - (last y) and F of the dual
/// step, which all but ignores the modes that one iteration settles, a frame starts cold when d'Fd > limit y'Fy. On
/// the 80x80 eye a scene that stands still reads .001 to .17 (noise of .1 to 9 white pixels squared), one that pans by
/// a pixel a frame .03 to .2, a cut to another picture .36 and more.
template <class T>
class WarmStart {
 public:
  static constexpr double limit = 0.3;

  /// Comes first in the workspace: what it keeps must lie at the same place in every frame. `rho` tells problems apart.
  WarmStart(const FrameProblem<T>& problem, bool wanted, T rho, Workspace& workspace) noexcept;

  /// True when the last frame's iterates fit this problem and this frame's samples.
  [[nodiscard]] bool allowed(WeightedDualStep<T>& dual_step) const noexcept;

  /// The iterates now in the workspace belong to these samples; or, after a frame that went wrong, to none.
  void keep(const FrameSamples<T>& samples, bool usable) noexcept;

  /// Makes the next frame in this workspace start cold. `workspace` may be any memory that solve() takes.
  static void forget(std::byte* workspace) noexcept;

 private:
  struct Mark {
    std::uint64_t problem;
  };

  [[nodiscard]] std::uint64_t mark_of_problem() const noexcept;

  const FrameProblem<T>* problem_;
  T rho_;
  Mark* mark_ = nullptr;
  T* last_values_ = nullptr;  // nought where a channel was missing
};

extern template class WarmStart<float>;
extern template class WarmStart<double>;

}  // namespace compueye::recon::core
