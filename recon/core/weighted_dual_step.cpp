#include "recon/core/weighted_dual_step.hpp"

#include "recon/core/cholesky.hpp"
#include "recon/core/proximal.hpp"
#include "recon/core/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double least_weight = 1e-6;

}  // namespace

template <class T>
WeightedDualStep<T>::WeightedDualStep(const FrameProblem<T>& problem, Workspace& workspace) noexcept
    : problem_(&problem),
      samples_(problem, workspace),
      residual_(workspace.take<T>(problem.a.rows)),
      step_(workspace.take<T>(problem.a.rows)),
      index_(workspace.take<std::size_t>(problem.max_reweighted)),
      substitution_(workspace.take<double>(problem.max_reweighted * problem.max_reweighted)),
      unknown_(workspace.take<double>(problem.max_reweighted)),
      scratch_(workspace.take<T>(problem.dual_step.scratch_size())) {}

template <class T>
bool WeightedDualStep<T>::begin(const float* y, const float* weights) noexcept {
  reweighted_ = 0;
  if (!samples_.gather(y, weights) || samples_.channels_reweighted() > problem_->max_reweighted) return false;
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    if (samples_.weights()[i] != T(1)) index_[reweighted_++] = i;
  }
  return factor_substitution();
}

template <class T>
bool WeightedDualStep<T>::factor_substitution() noexcept {
  const std::size_t n = reweighted_;
  if (n == 0) return true;
  restrict_to(problem_->dual_step, index_, n, substitution_, scratch_);
  for (std::size_t s = 0; s < n; ++s) {
    if (is_missing(index_[s])) continue;
    const double weight = static_cast<double>(samples_.weights()[index_[s]]);
    substitution_[s * n + s] += weight / (1.0 - weight);
  }
  return cholesky_factor(substitution_, n);
}

template <class T>
void WeightedDualStep<T>::apply(const T* x, T* u) noexcept {
  const std::size_t rows = problem_->a.rows;
  samples_.residual(x, residual_);
  for (std::size_t i = 0; i < rows; ++i) residual_[i] += u[i];
  for (std::size_t s = 0; s < reweighted_; ++s) {
    const std::size_t i = index_[s];
    residual_[i] = is_missing(i) ? T(0) : residual_[i] + (u[i] / samples_.weights()[i] - u[i]);
  }
  flush_tiny(residual_, rows);
  core::apply(problem_->dual_step, residual_, step_, scratch_);
  if (reweighted_ > 0) {
    for (std::size_t s = 0; s < reweighted_; ++s) unknown_[s] = static_cast<double>(step_[index_[s]]);
    cholesky_solve(substitution_, reweighted_, unknown_);
    for (std::size_t s = 0; s < reweighted_; ++s) residual_[index_[s]] -= static_cast<T>(unknown_[s]);
    core::apply(problem_->dual_step, residual_, step_, scratch_);
  }
  for (std::size_t i = 0; i < rows; ++i) u[i] -= problem_->relaxation * step_[i];
  for (std::size_t s = 0; s < reweighted_; ++s) {
    if (is_missing(index_[s])) u[index_[s]] = T(0);
  }
  flush_tiny(u, rows);
}

template <class T>
bool WeightedDualStep<T>::is_missing(std::size_t row) const noexcept {
  return static_cast<double>(samples_.weights()[row]) < least_weight;
}

template <class T>
double WeightedDualStep<T>::squared_size(const T* r) noexcept {
  core::apply(problem_->dual_step, r, step_, scratch_);
  return static_cast<double>(dot(r, step_, problem_->a.rows));
}

template class WeightedDualStep<float>;
template class WeightedDualStep<double>;

}  // namespace compueye::recon::core
