#pragma once

#include <cstddef>

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_info.hpp"
#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"

namespace compueye::recon::core {

/// Hands out the solution times `unit`; or all zeros with Health::invalid and figures of 0 when `usable` is false, the
/// solution is at no_bound, or x or its objective is not finite. Comes last, after evaluate().
template <class T>
void deliver(const T* solution, double unit, bool usable, std::size_t n, FrameInfo& info, float* x) noexcept;

/// Fills in the residual, the channel counts and the objective with the given penalty term; `scratch` takes
/// problem.a.rows values.
template <class T>
void evaluate(const FrameSamples<T>& samples, const T* solution, double penalty, T* scratch, FrameInfo& info) noexcept;

/// lambda ||c||_1 of psi.coefficients() coefficients.
template <class T>
[[nodiscard]] double l1_penalty(const FrameProblem<T>& problem, const T* coefficients) noexcept;

/// Health of an iterative method, whose steps grow small long before the end where A is ill-conditioned: converged when
/// the gap is at most 1e-3 of the objective, which is then several times closer to its optimum. Nothing else proves
/// that, so a frame whose gap was not measured has used its budget; where the problem has no gap to measure, the larger
/// residual has to be below `still`. The gap is told where it was asked for.
template <class T>
void judge_by_gap(const FrameProblem<T>& problem, const DualityGap<T>& measured, double gap, double still,
                  FrameInfo& info) noexcept;

/// `still` of methods whose steps grow small long before the end, and of those that split.
inline constexpr double still_step = 1e-6, still_split = 1e-3;

/// Squares over all copies of x after an iteration of a splitting method: how far they are from x, how far they moved,
/// and the sizes to compare those with.
struct SplitResiduals {
  double apart = 0.0, moved = 0.0;
  double of_x = 0.0, of_copies = 0.0, of_duals = 0.0;

  /// Adds one copy: x as the quadratic step left it, z what its proximal map made of it, z before and the scaled dual.
  template <class T>
  void add(const T* x, const T* z, const T* before, const T* dual, std::size_t n) noexcept;

  /// Fills in both residuals, which say how still the last iteration was, not how near the optimum is: those of Boyd et
  /// al. 2011, section 3.3.1, relative to the sizes named there, or to a hundredth of the other size where that is
  /// more, as at an x that is exactly zero, or where constraint and l1 term are idle.
  void tell(FrameInfo& info) const noexcept;
};

}  // namespace compueye::recon::core
