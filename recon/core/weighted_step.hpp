#pragma once

#include <cstddef>

#include "recon/core/frame_problem.hpp"
#include "recon/core/workspace.hpp"

namespace compueye::recon::core {

/// The quadratic step of a frame, for weights that change from frame to frame while the factor stays:
///
///   x = argmin 1/2 ||W^(1/2)(A x - y)||^2 + rho/2 (x - v)' K0 (x - v)
///     = v + K0^-1 A' (A K0^-1 A' + rho W^-1)^-1 (y - A v)
///
/// With H = (A K0^-1 A' + rho I)^-1 cached and S the channels whose weight is not one, Woodbury's identity gives
///
///   (A K0^-1 A' + rho W^-1)^-1 r = H (r - E_S c),  (H_SS + D) c = (H r)_S,  D = diag(w / (rho (1 - w)))
///
/// that is: the residual of a missing channel is replaced by the value that makes it carry no information. It is
/// exact, costs |S| M once for the rows H_S and |S|^3/6 for their factor, and |S| M more an iteration.
template <class T>
class WeightedStep {
 public:
  WeightedStep(const FrameProblem<T>& problem, Workspace& workspace) noexcept;

  /// Takes the frame's samples: `y` and `weights` have problem.channels entries, weights null means all one.
  /// False when y is not finite at a channel in use, a weight is outside 0..1 or too many differ from one.
  [[nodiscard]] bool begin(const float* y, const float* weights) noexcept;

  /// v becomes x.
  void apply(T* v) noexcept;

  /// ||W^(1/2)(A x - y)||^2
  [[nodiscard]] double squared_residual(const T* x) noexcept;

  [[nodiscard]] std::size_t channels_used() const noexcept { return used_; }
  [[nodiscard]] std::size_t channels_reweighted() const noexcept { return reweighted_; }

 private:
  [[nodiscard]] bool gather(const float* y, const float* weights) noexcept;
  [[nodiscard]] bool factor_substitution() noexcept;
  void substitute() noexcept;

  const FrameProblem<T>* problem_;
  T* samples_;
  T* weights_;
  T* residual_;
  T* correction_;
  std::size_t* index_;    // S, positions among the seeing rows
  T* inverse_rows_;       // H_S, |S| x rows
  double* substitution_;  // Cholesky factor of H_SS + D
  double* unknown_;       // c
  T* smooth_ = nullptr;   // K0^-1 A' s, when K0 is not the identity
  T* coefficients_ = nullptr;
  T* scratch_ = nullptr;
  std::size_t used_ = 0;
  std::size_t reweighted_ = 0;
};

extern template class WeightedStep<float>;
extern template class WeightedStep<double>;

}  // namespace compueye::recon::core
