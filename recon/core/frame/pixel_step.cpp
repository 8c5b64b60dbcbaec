#include "recon/core/frame/pixel_step.hpp"

#include "recon/core/parts/cholesky.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
void weigh_residual(const FrameSamples<T>& samples, const T* shift, std::size_t rows, T* residual) noexcept {
  const T* weights = samples.weights();
  for (std::size_t i = 0; i < rows; ++i)
    residual[i] = weights[i] * (residual[i] - (shift == nullptr ? T(0) : shift[i]));
}

/// Row i of A, where it can be read; false: it cannot.
template <class T>
bool read_row(const LinearOperator<T>& a, std::size_t i, double* row) noexcept {
  if (a.kind == OperatorKind::dense) {
    for (std::size_t n = 0; n < a.cols; ++n) row[n] = static_cast<double>(a.values[i * a.cols + n]);
    return true;
  }
  if (a.kind != OperatorKind::csr) return false;
  for (std::size_t n = 0; n < a.cols; ++n) row[n] = 0.0;
  for (std::size_t e = a.row_start[i]; e < a.row_start[i + 1]; ++e) {
    row[a.columns[e]] = static_cast<double>(a.values[e]);
  }
  return true;
}

}  // namespace

template <class T>
PixelStep<T>::PixelStep(const FactoredProblem<T>& problem, Workspace& workspace) noexcept
    : problem_(&problem),
      n_(problem.pixel_inverse.order),
      gradient_(workspace.take<T>(n_)),
      lacks_(workspace.take<double>(n_)),
      change_(workspace.take<double>(n_)),
      matrix_(workspace.take<double>(problem.max_reweighted > 0 ? n_ * n_ : 0)) {
  if (n_ == 0 || problem.metric.is_identity()) return;
  coefficients_ = workspace.take<T>(problem.psi.coefficients());
  scratch_ = workspace.take<T>(problem.psi.scratch_size());
}

template <class T>
bool PixelStep<T>::begin(const FrameSamples<T>& samples, T* row_scratch) noexcept {
  whole_ = samples.channels_reweighted() == 0;
  if (whole_) return true;
  if (samples.channels_reweighted() > problem_->max_reweighted) return false;
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j <= i; ++j) matrix_[i * n_ + j] = problem_->pixel_matrix.at(j, i);
  }
  for (std::size_t i = 0; i < problem_->a.rows; ++i) row_scratch[i] = T(0);
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    if (samples.weights()[i] != T(1)) take_off(samples, i, row_scratch);
  }
  return cholesky_factor(matrix_, n_);
}

/// matrix -= (1 - w) a a'; `row_scratch` is all nought between calls.
template <class T>
void PixelStep<T>::take_off(const FrameSamples<T>& samples, std::size_t row, T* row_scratch) noexcept {
  if (!read_row(problem_->a, row, lacks_)) {
    row_scratch[row] = T(1);
    for (std::size_t k = 0; k < n_; ++k) gradient_[k] = T(0);
    samples.adjoint_accumulate(row_scratch, gradient_);
    for (std::size_t k = 0; k < n_; ++k) lacks_[k] = static_cast<double>(gradient_[k]);
    row_scratch[row] = T(0);
  }
  const double share = 1.0 - static_cast<double>(samples.weights()[row]);
  for (std::size_t k = 0; k < n_; ++k) {
    if (lacks_[k] != 0.0) accumulate(lacks_, -share * lacks_[k], matrix_ + k * n_, k + 1);
  }
}

template <class T>
void PixelStep<T>::apply(const FrameSamples<T>& samples, T* v, T* pull, T* residual, const T* shift,
                         T* correction) noexcept {
  const std::size_t rows = problem_->a.rows;
  for (std::size_t k = 0; k < n_; ++k) gradient_[k] = v[k] + pull[k];
  samples.residual(gradient_, residual);
  weigh_residual(samples, shift, rows, residual);
  pull_back(pull);
  samples.adjoint_accumulate(residual, gradient_);
  solve();
  for (std::size_t k = 0; k < n_; ++k) pull[k] += static_cast<T>(change_[k]);
  flush_tiny(pull, n_);
  for (std::size_t k = 0; k < n_; ++k) v[k] += pull[k];
  flush_tiny(v, n_);
  if (shift == nullptr) return;
  samples.residual(v, correction);
  weigh_residual(samples, shift, rows, correction);
  for (std::size_t i = 0; i < rows; ++i) correction[i] /= problem_->rho;
}

/// gradient = -rho K0 p
template <class T>
void PixelStep<T>::pull_back(const T* pull) noexcept {
  for (std::size_t k = 0; k < n_; ++k) gradient_[k] = T(0);
  if (!problem_->metric.is_identity()) {
    analyse(problem_->psi, pull, coefficients_, scratch_);
    synthesise(problem_->psi, coefficients_, gradient_, scratch_);
  }
  for (std::size_t k = 0; k < n_; ++k) gradient_[k] = -problem_->rho * (gradient_[k] + pull[k]);
}

/// change = H_W gradient
template <class T>
void PixelStep<T>::solve() noexcept {
  for (std::size_t k = 0; k < n_; ++k) lacks_[k] = static_cast<double>(gradient_[k]);
  if (whole_) return multiply(problem_->pixel_inverse, lacks_, change_);
  for (std::size_t k = 0; k < n_; ++k) change_[k] = lacks_[k];
  cholesky_solve(matrix_, n_, change_);
}

template class PixelStep<float>;
template class PixelStep<double>;

}  // namespace compueye::recon::core
