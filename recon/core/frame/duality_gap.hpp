#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// How far a frame's objective can lie above its optimum, by weak duality. The dual of
///
///   min 1/2 ||W^(1/2)(A x - y)||^2 + lambda ||Psi x||_1,  lo <= x <= hi
///
/// is  max u'y - 1/2 u'W^-1 u - sup_{lo <= x <= hi} x'(A'u - Psi'q)  over |q| <= lambda and u zero at missing channels
/// (Boyd & Vandenberghe 2004, section 5.1.6). u is taken as the weighted residual and q as the solver has it; both are
/// then moved to the nearest dual feasible point that is cheap: by Psi itself where it is orthonormal, by D (D'D)^+
/// for total variation, and by a scaling that brings q into its bounds (El Ghaoui et al. 2012, section 3.3).
/// With problem.bounded it is the dual of min ||Psi x||_1 subject to ||W^(1/2)(A x - y)|| <= epsilon.
template <class T>
class DualityGap {
 public:
  /// Takes memory, and measures, only when `wanted` and defined.
  DualityGap(const FrameProblem<T>& problem, bool wanted, Workspace& workspace) noexcept;

  /// Whether the problem has a gap, wanted or not: an l1 term or a box, and not an epsilon with a box.
  [[nodiscard]] bool defined() const noexcept { return defined_; }

  /// `dual` is q, psi.coefficients() values within +-lambda; may be null for a basis that is the identity or meets no
  /// constraint. Negative when the gap is not wanted or not defined: a lambda of zero without a box, or an epsilon
  /// with one.
  [[nodiscard]] double measure(const FrameSamples<T>& samples, const T* x, const T* dual, double objective) noexcept;

 private:
  void take_residual(const FrameSamples<T>& samples, const T* x) noexcept;
  void take_sizes(const FrameSamples<T>& samples) noexcept;
  void back_project(const FrameSamples<T>& samples) noexcept;
  void pull_by_basis(const T* dual) noexcept;
  void balance_mean(const FrameSamples<T>& samples) noexcept;
  [[nodiscard]] double largest_coefficient(const FrameSamples<T>& samples, const T* dual) noexcept;
  [[nodiscard]] double largest_tv_coefficient(const FrameSamples<T>& samples, const T* dual) noexcept;
  [[nodiscard]] double pixel_support(double scale) const noexcept;
  [[nodiscard]] double box_dual_value(const T* dual) noexcept;
  [[nodiscard]] double scaled_dual_value(double largest) const noexcept;

  const FrameProblem<T>& problem_;
  std::size_t n_;
  bool one_sided_;  // x >= 0: A'u - Psi'q may be negative
  bool boxed_;
  bool defined_;
  bool wanted_;  // and defined
  T* u_ = nullptr;
  T* white_ = nullptr;   // A 1, for tv
  T* back_ = nullptr;    // A'u
  T* excess_ = nullptr;  // A'u - Psi'q
  T* coefficients_ = nullptr;
  T* scratch_ = nullptr;
  double u_y_ = 0.0;  // u'y
  double u_u_ = 0.0;  // u' W^-1 u
};

extern template class DualityGap<float>;
extern template class DualityGap<double>;

}  // namespace compueye::recon::core
