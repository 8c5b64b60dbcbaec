#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// The residual W^(1/2)(y - A x) as a variable of its own, with its scaled dual, beside the pixels of core/adm.hpp: its
/// proximal map is a projection on the ball of radius epsilon when problem.bounded, and otherwise that of
/// 1/2 ||.||^2, a shrinking. A channel of weight zero has none.
template <class T>
class ResidualCopy {
 public:
  ResidualCopy(const FactoredProblem<T>& problem, Workspace& workspace) noexcept;

  /// `penalty` is that of the augmented Lagrangian on the residual's dual; a ball does not need it.
  void begin(const FrameSamples<T>& samples, T penalty) noexcept;

  /// The proximal map; returns what it takes from y, one value a seeing row.
  [[nodiscard]] const T* shift() noexcept;

  /// Takes over what the quadratic step made of it (WeightedStep::correction()).
  void update(const T* correction, T step) noexcept;

 private:
  const FactoredProblem<T>& problem_;
  T* residual_ = nullptr;  // W^(1/2) (y - A x)
  T* dual_ = nullptr;
  T* near_ = nullptr;  // the proximal point
  T* shift_ = nullptr;
  T* root_weight_ = nullptr;
  T penalty_ = T(1);
};

extern template class ResidualCopy<float>;
extern template class ResidualCopy<double>;

}  // namespace compueye::recon::core
