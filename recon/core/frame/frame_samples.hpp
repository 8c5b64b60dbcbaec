#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// The samples and weights of one frame at the seeing channels, and A with the memory that it works in. What a channel
/// of weight zero reads is never looked at.
template <class T>
class FrameSamples {
 public:
  FrameSamples(const FrameProblem<T>& problem, Workspace& workspace) noexcept;

  /// `y` and `weights` have problem.channels entries, weights null means all one. False when y is not finite at a
  /// channel in use or a weight is outside 0..1.
  [[nodiscard]] bool gather(const float* y, const float* weights) noexcept;

  /// y = A x and x += A' y
  void forward(const T* x, T* y) const noexcept { core::forward(problem_->a, x, y, operator_scratch_); }
  void adjoint_accumulate(const T* y, T* x) const noexcept {
    core::adjoint_accumulate(problem_->a, y, x, operator_scratch_);
  }

  /// residual = y - A x, zero at channels of weight zero.
  void residual(const T* x, T* residual) const noexcept;

  /// ||W^(1/2)(A x - y)||^2; `scratch` takes problem.a.rows values.
  [[nodiscard]] double squared_residual(const T* x, T* scratch) const noexcept;

  /// values() are y in this unit.
  [[nodiscard]] const FrameUnit& unit() const noexcept { return unit_; }
  [[nodiscard]] const T* values() const noexcept { return values_; }
  [[nodiscard]] const T* weights() const noexcept { return weights_; }
  [[nodiscard]] std::size_t channels_used() const noexcept { return used_; }
  [[nodiscard]] std::size_t channels_reweighted() const noexcept { return reweighted_; }

 private:
  void choose_unit(const float* y, const float* weights) noexcept;

  const FrameProblem<T>* problem_;
  FrameUnit unit_;
  T* values_;
  T* weights_;
  T* operator_scratch_;
  std::size_t used_ = 0;
  std::size_t reweighted_ = 0;
};

extern template class FrameSamples<float>;
extern template class FrameSamples<double>;

}  // namespace compueye::recon::core
