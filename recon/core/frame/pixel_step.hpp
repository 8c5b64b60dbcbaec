#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// The quadratic step of core/frame/weighted_step.hpp on the side of the pixels, for an A with many more rows: x = v +
/// p with
///
///   (A'W A + rho K0) p = A'W (y - A v)
///
/// p is carried from one step to the next, and each adds what it lacks, p += H_W (A'W (y - A (v + p)) - rho K0 p): the
/// refinement of the step on the side of the rows, where H_W = (A'W A + rho K0)^-1. For weights of one it is
/// problem.pixel_inverse, in double whatever T is, because A'A has the squares of A's singular values. For others
/// A'W A + rho K0 is problem.pixel_matrix less (1 - w) a a' of each channel, factored anew: |S| N^2 + N^3 / 6 once a
/// frame, whatever the number of channels.
template <class T>
class PixelStep {
 public:
  PixelStep(const FactoredProblem<T>& problem, Workspace& workspace) noexcept;

  /// A frame's weights. `row_scratch` takes problem.a.rows values. False when numbers run out of range.
  [[nodiscard]] bool begin(const FrameSamples<T>& samples, T* row_scratch) noexcept;

  /// v becomes x, `pull` p. With a `shift`, y - shift takes the place of y and `correction` becomes W (y - shift - A x)
  /// / rho. `residual` takes problem.a.rows values.
  void apply(const FrameSamples<T>& samples, T* v, T* pull, T* residual, const T* shift, T* correction) noexcept;

 private:
  void take_off(const FrameSamples<T>& samples, std::size_t row, T* row_scratch) noexcept;
  void pull_back(const T* pull) noexcept;
  void solve() noexcept;

  const FactoredProblem<T>* problem_;
  std::size_t n_;
  T* gradient_;
  T* coefficients_ = nullptr;  // when K0 is not the identity
  T* scratch_ = nullptr;
  double* lacks_;      // of p
  double* change_;     // of p
  double* matrix_;     // the factor of a reweighted frame
  bool whole_ = true;  // all weights are one
};

extern template class PixelStep<float>;
extern template class PixelStep<double>;

}  // namespace compueye::recon::core
