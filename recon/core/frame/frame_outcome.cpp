#include "recon/core/frame/frame_outcome.hpp"

#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double converged_gap = 1e-3;

}  // namespace

template <class T>
void deliver(const T* solution, double unit, bool usable, std::size_t n, FrameInfo& info, float* x) noexcept {
  // A float32 x may overflow where a double solution did not; objectives overflow before either. At no_bound a proximal
  // map has clipped what had no bound.
  for (std::size_t k = 0; k < n; ++k) {
    usable = usable && solution[k] < T(no_bound) && solution[k] > T(-no_bound);
    x[k] = usable ? static_cast<float>(static_cast<double>(solution[k]) * unit) : 0.0F;
  }
  if (usable && all_finite(x, n) && all_finite(&info.objective, 1)) return;
  for (std::size_t k = 0; k < n; ++k) x[k] = 0.0F;
  info.health = Health::invalid;
  info.objective = info.residual = info.primal_residual = info.dual_residual = 0.0;
}

template <class T>
void evaluate(const FrameSamples<T>& samples, const T* solution, double penalty, T* scratch, FrameInfo& info) noexcept {
  const double squared = samples.squared_residual(solution, scratch);
  info.residual = square_root(squared);
  info.objective = 0.5 * squared + penalty;
  info.channels_used = static_cast<int>(samples.channels_used());
  info.channels_reweighted = static_cast<int>(samples.channels_reweighted());
}

template <class T>
double l1_penalty(const FrameProblem<T>& problem, const T* coefficients) noexcept {
  const double magnitudes = static_cast<double>(sum_of_magnitudes(coefficients, problem.psi.coefficients()));
  return static_cast<double>(problem.lambda) * magnitudes;
}

template <class T>
void judge_by_gap(const FrameProblem<T>& problem, const DualityGap<T>& measured, double gap, double still,
                  FrameInfo& info) noexcept {
  const double step = info.primal_residual > info.dual_residual ? info.primal_residual : info.dual_residual;
  const bool settled = measured.defined() ? gap >= 0.0 && gap <= converged_gap * info.objective : step < still;
  info.duality_gap = problem.measure_gap ? gap : -1.0;
  info.iterations = problem.point.iterations;
  info.health = settled ? Health::converged : Health::budget_used;
}

template void deliver(const float*, double, bool, std::size_t, FrameInfo&, float*) noexcept;
template void deliver(const double*, double, bool, std::size_t, FrameInfo&, float*) noexcept;
template void evaluate(const FrameSamples<float>&, const float*, double, float*, FrameInfo&) noexcept;
template void evaluate(const FrameSamples<double>&, const double*, double, double*, FrameInfo&) noexcept;
template double l1_penalty(const FrameProblem<float>&, const float*) noexcept;
template double l1_penalty(const FrameProblem<double>&, const double*) noexcept;
template void judge_by_gap(const FrameProblem<float>&, const DualityGap<float>&, double, double, FrameInfo&) noexcept;
template void judge_by_gap(const FrameProblem<double>&, const DualityGap<double>&, double, double, FrameInfo&) noexcept;

namespace {

/// sqrt(square / size), the size being at least a ten-thousandth of `other` (squares: a hundredth in length).
double relative(double square, double size, double other) noexcept {
  const double least = 1e-4 * other;
  const double scale = size > least ? size : least;
  return scale > 0.0 ? square_root(square / scale) : 0.0;
}

}  // namespace

template <class T>
void SplitResiduals::add(const T* x, const T* z, const T* before, const T* dual, std::size_t n) noexcept {
  apart += static_cast<double>(squared_distance(x, z, n));
  moved += static_cast<double>(squared_distance(z, before, n));
  of_x += static_cast<double>(dot(x, x, n));
  of_copies += static_cast<double>(dot(z, z, n));
  of_duals += static_cast<double>(dot(dual, dual, n));
}

void SplitResiduals::tell(FrameInfo& info) const noexcept {
  const double variables = of_x > of_copies ? of_x : of_copies;
  info.primal_residual = relative(apart, variables, of_duals);
  info.dual_residual = relative(moved, of_duals, variables);
}

template void SplitResiduals::add(const float*, const float*, const float*, const float*, std::size_t) noexcept;
template void SplitResiduals::add(const double*, const double*, const double*, const double*, std::size_t) noexcept;

}  // namespace compueye::recon::core
