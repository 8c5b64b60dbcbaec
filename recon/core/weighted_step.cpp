#include "recon/core/weighted_step.hpp"

#include "recon/core/cholesky.hpp"
#include "recon/core/proximal.hpp"
#include "recon/core/vector_sums.hpp"

namespace compueye::recon::core {

template <class T>
WeightedStep<T>::WeightedStep(const FrameProblem<T>& problem, Workspace& workspace) noexcept
    : problem_(&problem),
      samples_(problem, workspace),
      residual_(workspace.take<T>(problem.a.rows)),
      correction_(workspace.take<T>(problem.a.rows)),
      index_(workspace.take<std::size_t>(problem.max_reweighted)),
      inverse_rows_(workspace.take<T>(problem.max_reweighted * problem.a.rows)),
      substitution_(workspace.take<double>(problem.max_reweighted * problem.max_reweighted)),
      unknown_(workspace.take<double>(problem.max_reweighted)),
      inverse_scratch_(workspace.take<T>(problem.inverse.scratch_size())) {
  if (problem.metric.is_identity()) return;
  smooth_ = workspace.take<T>(problem.pixels());
  coefficients_ = workspace.take<T>(problem.pixels());
  scratch_ =
      workspace.take<T>(dct_scratch_size(problem.image_rows, problem.image_cols) * problem.metric.dct.crew.workers);
}

template <class T>
bool WeightedStep<T>::begin(const float* y, const float* weights) noexcept {
  reweighted_ = 0;
  if (!samples_.gather(y, weights) || samples_.channels_reweighted() > problem_->max_reweighted) return false;
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    if (samples_.weights()[i] != T(1)) index_[reweighted_++] = i;
  }
  return factor_substitution();
}

template <class T>
bool WeightedStep<T>::factor_substitution() noexcept {
  const std::size_t n = reweighted_;
  for (std::size_t s = 0; s < n; ++s) {
    T* row = inverse_rows_ + s * problem_->a.rows;
    expand_row(problem_->inverse, index_[s], row, inverse_scratch_);
    for (std::size_t t = 0; t <= s; ++t) substitution_[s * n + t] = static_cast<double>(row[index_[t]]);
    const double weight = static_cast<double>(samples_.weights()[index_[s]]);
    substitution_[s * n + s] += weight / (static_cast<double>(problem_->rho) * (1.0 - weight));
  }
  return n == 0 || cholesky_factor(substitution_, n);
}

template <class T>
void WeightedStep<T>::substitute() noexcept {
  for (std::size_t s = 0; s < reweighted_; ++s) {
    unknown_[s] = static_cast<double>(dot(inverse_rows_ + s * problem_->a.rows, residual_, problem_->a.rows));
  }
  cholesky_solve(substitution_, reweighted_, unknown_);
  for (std::size_t s = 0; s < reweighted_; ++s) residual_[index_[s]] -= static_cast<T>(unknown_[s]);
}

template <class T>
void WeightedStep<T>::apply(T* v, const T* shift) noexcept {
  const std::size_t rows = problem_->a.rows;
  samples_.residual(v, residual_);
  for (std::size_t i = 0; shift != nullptr && i < rows; ++i) residual_[i] -= shift[i];
  if (reweighted_ > 0) substitute();
  flush_tiny(residual_, rows);
  multiply(problem_->inverse, residual_, correction_, inverse_scratch_);
  for (std::size_t s = 0; s < reweighted_; ++s) {
    if (samples_.weights()[index_[s]] == T(0)) correction_[index_[s]] = T(0);
  }
  flush_tiny(correction_, rows);
  if (problem_->metric.is_identity()) {
    samples_.adjoint_accumulate(correction_, v);
  } else {
    for (std::size_t k = 0; k < problem_->pixels(); ++k) smooth_[k] = T(0);
    samples_.adjoint_accumulate(correction_, smooth_);
    apply_inverse(problem_->metric, smooth_, coefficients_, scratch_);
    for (std::size_t k = 0; k < problem_->pixels(); ++k) v[k] += smooth_[k];
  }
  flush_tiny(v, problem_->pixels());
}

template class WeightedStep<float>;
template class WeightedStep<double>;

}  // namespace compueye::recon::core
