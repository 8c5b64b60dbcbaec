#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/frame/reweighted_channels.hpp"
#include "recon/core/parts/deflated_step.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// u -= theta F_W (W^-1 u - (A x - y)) for weights that change from frame to frame while the modes stay: the proximal
/// map of the conjugate data term 1/2 u' W^-1 u + y'u in the metric Sigma. With F = (Sigma^-1 + I)^-1 for weights of
/// one, S the channels whose weight is another and Woodbury's identity,
///
///   F_W r = (Sigma^-1 + W^-1)^-1 r = F (r - E_S c),  (F_SS + D) c = (F r)_S,  D = diag(w / (1 - w))
///
/// so that the metric Sigma, and with it the bound on the steps, is that of the whole eye whatever is missing. Costs
/// |S|^2 times the number of modes and |S|^3/6 once a frame, and a second F an iteration. A weight below 1e-6 is
/// taken as none: W^-1 u would be all rounding.
template <class T>
class WeightedDualStep {
 public:
  /// `step` is F, relaxation theta.
  WeightedDualStep(const FrameProblem<T>& problem, const DeflatedStep<T>& step, T relaxation,
                   Workspace& workspace) noexcept;

  /// Takes the frame's samples and weights, see FrameSamples::gather(). False too when more weights than planned differ
  /// from one.
  [[nodiscard]] bool begin(const float* y, const float* weights) noexcept;

  /// The level of tau that apply() uses from here on. Frames with a weight other than one stay at the first, for which
  /// alone the identity above is set up.
  void set_level(std::size_t level) noexcept { level_ = reweighted_.count() == 0 ? level : 0; }
  [[nodiscard]] std::size_t level() const noexcept { return level_; }

  /// Moves u; `x` has a.cols values, u a.rows. u stays nought at missing channels.
  void apply(const T* x, T* u) noexcept;

  /// F_W (W^-1 u - (A x - y)) of the last apply(): how far u was off, before relaxation.
  [[nodiscard]] const T* last_step() const noexcept { return step_; }

  /// r' F r at the first level, and F r is left in last_step().
  [[nodiscard]] double squared_size(const T* r) noexcept;

  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }
  /// problem.a.rows values that are free between calls.
  [[nodiscard]] T* row_scratch() noexcept { return residual_; }

 private:
  [[nodiscard]] bool factor_substitution() noexcept;
  [[nodiscard]] bool is_missing(std::size_t row) const noexcept;

  const DeflatedStep<T>* deflated_;
  T relaxation_;
  std::size_t seeing_;
  FrameSamples<T> samples_;
  T* residual_;
  T* step_;
  ReweightedChannels<T> reweighted_;
  T* scratch_;
  std::size_t level_ = 0;
};

extern template class WeightedDualStep<float>;
extern template class WeightedDualStep<double>;

}  // namespace compueye::recon::core
