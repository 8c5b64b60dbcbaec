#pragma once

#include <cstddef>

#include "recon/core/frame_problem.hpp"
#include "recon/core/frame_samples.hpp"
#include "recon/core/workspace.hpp"

namespace compueye::recon::core {

/// The residual of min ||Psi x||_1 subject to ||W^(1/2)(A x - y)|| <= epsilon as a variable of its own, with its scaled
/// dual, beside the pixels of core/adm.hpp. A channel of weight zero has none.
template <class T>
class ResidualBall {
 public:
  /// Takes memory only when problem.bounded is set.
  ResidualBall(const FrameProblem<T>& problem, Workspace& workspace) noexcept;

  void begin(const FrameSamples<T>& samples) noexcept;

  /// Projects on the ball; returns what the projection takes from y, one value a seeing row.
  [[nodiscard]] const T* project() noexcept;

  /// Takes over what the quadratic step made of it (WeightedStep::correction()).
  void update(const T* correction, T step) noexcept;

 private:
  const FrameProblem<T>& problem_;
  T* residual_ = nullptr;  // W^(1/2) (y - A x)
  T* dual_ = nullptr;
  T* projected_ = nullptr;
  T* shift_ = nullptr;
  T* root_weight_ = nullptr;
};

extern template class ResidualBall<float>;
extern template class ResidualBall<double>;

}  // namespace compueye::recon::core
