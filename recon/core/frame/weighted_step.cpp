#include "recon/core/frame/weighted_step.hpp"

#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double least_weight = 1e-12;

}  // namespace

template <class T>
WeightedStep<T>::WeightedStep(const FactoredProblem<T>& problem, Workspace& workspace) noexcept
    : problem_(&problem),
      tall_(problem.pixel_inverse.order > 0),
      samples_(problem, workspace),
      residual_(workspace.take<T>(problem.a.rows)),
      step_(workspace.take<T>(problem.a.rows)),
      correction_(workspace.take<T>(problem.a.rows)),
      pull_(workspace.take<T>(problem.pixels())),
      on_pixels_(problem, workspace),
      reweighted_(tall_ ? 0 : problem.max_reweighted, 0, workspace),
      inverse_rows_(workspace.take<T>(tall_ ? 0 : problem.max_reweighted * problem.a.rows)),
      inverse_scratch_(workspace.take<T>(problem.inverse.scratch_size())) {
  if (tall_ || problem.metric.is_identity()) return;
  coefficients_ = workspace.take<T>(problem.pixels());
  scratch_ =
      workspace.take<T>(dct_scratch_size(problem.image_rows, problem.image_cols) * problem.metric.dct.crew.workers);
}

template <class T>
bool WeightedStep<T>::begin(const float* y, const float* weights) noexcept {
  for (std::size_t i = 0; i < problem_->a.rows; ++i) correction_[i] = T(0);
  for (std::size_t k = 0; k < problem_->pixels(); ++k) pull_[k] = T(0);
  if (!samples_.gather(y, weights)) return false;
  if (tall_) return on_pixels_.begin(samples_, residual_);
  return reweighted_.list(samples_) && factor_substitution();
}

template <class T>
bool WeightedStep<T>::factor_substitution() noexcept {
  const std::size_t n = reweighted_.count(), *rows = reweighted_.rows();
  double* matrix = reweighted_.matrix();
  for (std::size_t s = 0; s < n; ++s) {
    T* row = inverse_rows_ + s * problem_->a.rows;
    expand_row(problem_->inverse, rows[s], row, inverse_scratch_);
    for (std::size_t t = 0; t <= s; ++t) matrix[s * n + t] = static_cast<double>(row[rows[t]]);
    if (!is_missing(rows[s])) matrix[s * n + s] += diagonal(rows[s]);
  }
  return reweighted_.factor();
}

template <class T>
bool WeightedStep<T>::is_missing(std::size_t row) const noexcept {
  return static_cast<double>(samples_.weights()[row]) < least_weight;
}

template <class T>
double WeightedStep<T>::diagonal(std::size_t row) const noexcept {
  const double weight = static_cast<double>(samples_.weights()[row]);
  return weight / (static_cast<double>(problem_->rho) * (1.0 - weight));
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
  if (tall_) return on_pixels_.apply(samples_, v, pull_, residual_, shift, correction_);
  const std::size_t pixels = problem_->pixels();
  const auto add = [&](const T* what, T* to, bool flush) {
    problem_->crew.share(pixels, pixels, [&](std::size_t, std::size_t begin, std::size_t end) {
      accumulate(what + begin, T(1), to + begin, end - begin);
      if (flush) flush_tiny(to + begin, end - begin);
    });
  };
  add(v, pull_, false);
  improve_correction(shift);
  for (std::size_t k = 0; k < pixels; ++k) pull_[k] = T(0);
  samples_.adjoint_accumulate(correction_, pull_);
  if (!problem_->metric.is_identity()) apply_inverse(problem_->metric, pull_, coefficients_, scratch_);
  add(pull_, v, true);
}

/// What the correction lacks is what y - A x differs by from rho W^-1 times it, x being the picture in pull_.
template <class T>
void WeightedStep<T>::improve_correction(const T* shift) noexcept {
  const std::size_t rows = problem_->a.rows;
  samples_.residual(pull_, residual_);
  for (std::size_t i = 0; shift != nullptr && i < rows; ++i) residual_[i] -= shift[i];
  accumulate(correction_, -problem_->rho, residual_, rows);
  for (std::size_t s = 0; s < reweighted_.count(); ++s) {
    const std::size_t i = reweighted_.rows()[s];
    const double weight = static_cast<double>(samples_.weights()[i]);
    const double dual = static_cast<double>(problem_->rho) * static_cast<double>(correction_[i]);
    residual_[i] = is_missing(i) ? T(0) : residual_[i] + static_cast<T>(dual - dual / weight);
  }
  if (reweighted_.count() > 0) substitute();
  flush_tiny(residual_, rows);
  multiply(problem_->inverse, residual_, step_, inverse_scratch_);
  // The product is D c there, of which rounding would leave nothing at a small weight.
  for (std::size_t s = 0; s < reweighted_.count(); ++s) {
    const std::size_t i = reweighted_.rows()[s];
    step_[i] = is_missing(i) ? T(0) : static_cast<T>(diagonal(i) * reweighted_.values()[s]);
  }
  accumulate(step_, T(1), correction_, rows);
  flush_tiny(correction_, rows);
}

template class WeightedStep<float>;
template class WeightedStep<double>;

}  // namespace compueye::recon::core
