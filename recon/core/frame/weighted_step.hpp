#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/frame/pixel_step.hpp"
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
/// exact, costs |S| M once for the rows H_S and |S|^3/6 for their factor, and |S| M more an iteration. A weight below
/// 1e-12 is taken as none.
///
/// H is rounded, and an error e of it, relative, would change the weight of the data along a mode s of A A' by e (s /
/// rho)^2: with a few strong modes float32 then converges to another problem's picture. So c = (...)^-1 (y - A v) is
/// carried from one step to the next, and each step adds only what is missing of it,
///
///   c += H_W ((y - A (v + K0^-1 A'c)) - rho W^-1 c),   x = v + K0^-1 A'c
///
/// which costs the same products, is the same where H is exact, and where it is not ends at the same c as long as
/// e s / rho < 1: iterative refinement (Higham 2002, "Accuracy and stability of numerical algorithms", chapter 12) with
/// the iterations of the method as its own. A tall A is left to core/frame/pixel_step.hpp, and has no H.
template <class T>
class WeightedStep {
 public:
  WeightedStep(const FactoredProblem<T>& problem, Workspace& workspace) noexcept;

  /// Takes the frame's samples and weights, see FrameSamples::gather(). False too when more weights than planned differ
  /// from one.
  [[nodiscard]] bool begin(const float* y, const float* weights) noexcept;

  /// v becomes x; called again with the same v, it comes nearer to it. With a `shift` of problem.a.rows values, which
  /// is nought at missing channels, y - shift takes the place of y.
  void apply(T* v, const T* shift = nullptr) noexcept;

  /// (A K0^-1 A' + rho W^-1)^-1 (y - A v) of the last apply() with a shift, which is W (y - A x) / rho: one value a
  /// seeing row.
  [[nodiscard]] const T* correction() const noexcept { return correction_; }

  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }
  /// problem.a.rows values that are free between calls of apply().
  [[nodiscard]] T* row_scratch() noexcept { return residual_; }

 private:
  [[nodiscard]] bool factor_substitution() noexcept;
  [[nodiscard]] bool is_missing(std::size_t row) const noexcept;
  /// Of D, at a channel whose weight is not one.
  [[nodiscard]] double diagonal(std::size_t row) const noexcept;
  void substitute() noexcept;
  void improve_correction(const T* shift) noexcept;

  const FactoredProblem<T>* problem_;
  bool tall_;
  FrameSamples<T> samples_;
  T* residual_;
  T* step_;
  T* correction_;
  T* pull_;  // K0^-1 A' correction
  PixelStep<T> on_pixels_;
  ReweightedChannels<T> reweighted_;
  T* inverse_rows_;  // H_S, |S| x rows
  T* inverse_scratch_;
  T* coefficients_ = nullptr;  // when K0 is not the identity
  T* scratch_ = nullptr;
};

extern template class WeightedStep<float>;
extern template class WeightedStep<double>;

}  // namespace compueye::recon::core
