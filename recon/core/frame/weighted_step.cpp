#include "recon/core/frame/weighted_step.hpp"

#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

template <class T>
WeightedStep<T>::WeightedStep(const FactoredProblem<T>& problem, Workspace& workspace) noexcept
    : problem_(&problem),
      samples_(problem, workspace),
      residual_(workspace.take<T>(problem.a.rows)),
      correction_(workspace.take<T>(problem.a.rows)),
      reweighted_(problem.max_reweighted, workspace),
      inverse_rows_(workspace.take<T>(problem.max_reweighted * problem.a.rows)),
      inverse_scratch_(workspace.take<T>(problem.inverse.scratch_size())) {
  if (problem.metric.is_identity()) return;
  smooth_ = workspace.take<T>(problem.pixels());
  coefficients_ = workspace.take<T>(problem.pixels());
  scratch_ =
      workspace.take<T>(dct_scratch_size(problem.image_rows, problem.image_cols) * problem.metric.dct.crew.workers);
}

template <class T>
bool WeightedStep<T>::begin(const float* y, const float* weights) noexcept {
  return samples_.gather(y, weights) && reweighted_.list(samples_) && factor_substitution();
}

template <class T>
bool WeightedStep<T>::factor_substitution() noexcept {
  const std::size_t n = reweighted_.count(), *rows = reweighted_.rows();
  double* matrix = reweighted_.matrix();
  for (std::size_t s = 0; s < n; ++s) {
    T* row = inverse_rows_ + s * problem_->a.rows;
    expand_row(problem_->inverse, rows[s], row, inverse_scratch_);
    for (std::size_t t = 0; t <= s; ++t) matrix[s * n + t] = static_cast<double>(row[rows[t]]);
    const double weight = static_cast<double>(samples_.weights()[rows[s]]);
    matrix[s * n + s] += weight / (static_cast<double>(problem_->rho) * (1.0 - weight));
  }
  return reweighted_.factor();
}

template <class T>
void WeightedStep<T>::substitute() noexcept {
  const std::size_t rows = problem_->a.rows;
  for (std::size_t s = 0; s < reweighted_.count(); ++s) {
    reweighted_.values()[s] = static_cast<double>(dot(inverse_rows_ + s * rows, residual_, rows));
  }
  reweighted_.replace(residual_);
}

template <class T>
void WeightedStep<T>::apply(T* v, const T* shift) noexcept {
  const std::size_t rows = problem_->a.rows;
  samples_.residual(v, residual_);
  for (std::size_t i = 0; shift != nullptr && i < rows; ++i) residual_[i] -= shift[i];
  if (reweighted_.count() > 0) substitute();
  flush_tiny(residual_, rows);
  multiply(problem_->inverse, residual_, correction_, inverse_scratch_);
  for (std::size_t s = 0; s < reweighted_.count(); ++s) {
    const std::size_t i = reweighted_.rows()[s];
    if (samples_.weights()[i] == T(0)) correction_[i] = T(0);
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
