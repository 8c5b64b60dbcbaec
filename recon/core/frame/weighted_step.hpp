#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/frame/reweighted_channels.hpp"
#include "recon/core/parts/workspace.hpp"

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
  WeightedStep(const FactoredProblem<T>& problem, Workspace& workspace) noexcept;

  /// Takes the frame's samples and weights, see FrameSamples::gather(). False too when more weights than planned differ
  /// from one.
  [[nodiscard]] bool begin(const float* y, const float* weights) noexcept;

  /// v becomes x. With a `shift` of problem.a.rows values, which is nought at missing channels, y - shift takes the
  /// place of y.
  void apply(T* v, const T* shift = nullptr) noexcept;

  /// (A K0^-1 A' + rho W^-1)^-1 (y - A v) of the last apply(), which is W (y - A x) / rho: one value a seeing row.
  [[nodiscard]] const T* correction() const noexcept { return correction_; }

  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }
  /// problem.a.rows values that are free between calls of apply().
  [[nodiscard]] T* row_scratch() noexcept { return residual_; }

 private:
  [[nodiscard]] bool factor_substitution() noexcept;
  void substitute() noexcept;

  const FactoredProblem<T>* problem_;
  FrameSamples<T> samples_;
  T* residual_;
  T* correction_;
  ReweightedChannels<T> reweighted_;
  T* inverse_rows_;  // H_S, |S| x rows
  T* inverse_scratch_;
  T* smooth_ = nullptr;  // K0^-1 A' s, when K0 is not the identity
  T* coefficients_ = nullptr;
  T* scratch_ = nullptr;
};

extern template class WeightedStep<float>;
extern template class WeightedStep<double>;

}  // namespace compueye::recon::core
