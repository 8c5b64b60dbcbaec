#include "recon/core/frame/frame_samples.hpp"

#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

template <class T>
FrameSamples<T>::FrameSamples(const FrameProblem<T>& problem, Workspace& workspace) noexcept
    : problem_(&problem),
      values_(workspace.take<T>(problem.a.rows)),
      weights_(workspace.take<T>(problem.a.rows)),
      operator_scratch_(workspace.take<T>(problem.a.scratch_size())) {}

template <class T>
bool FrameSamples<T>::gather(const float* y, const float* weights) noexcept {
  choose_unit(y, weights);
  used_ = 0;
  reweighted_ = 0;
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    const auto channel = static_cast<std::size_t>(problem_->seeing[i]);
    const T weight = weights == nullptr ? T(1) : static_cast<T>(weights[channel]);
    if (!(weight >= T(0) && weight <= T(1))) return false;
    weights_[i] = weight;
    values_[i] = weight > T(0) ? static_cast<T>(static_cast<double>(y[channel]) * unit_.samples) : T(0);
    if (weight > T(0)) ++used_;
    if (weight != T(1)) ++reweighted_;
  }
  return all_finite(values_, problem_->a.rows);
}

template <class T>
void FrameSamples<T>::choose_unit(const float* y, const float* weights) noexcept {
  unit_ = problem_->unit;
  if (!problem_->homogeneous) return;
  double largest = 0.0;
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    const auto channel = static_cast<std::size_t>(problem_->seeing[i]);
    if (weights != nullptr && !(weights[channel] > 0.0F)) continue;
    const double value = static_cast<double>(y[channel]), size = value < 0.0 ? -value : value;
    if (size > largest) largest = size;
  }
  unit_ = unit_.for_samples_times(power_to_one(largest * unit_.samples));
}

template <class T>
void FrameSamples<T>::residual(const T* x, T* residual) const noexcept {
  forward(x, residual);
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    residual[i] = weights_[i] > T(0) ? values_[i] - residual[i] : T(0);
  }
}

template <class T>
double FrameSamples<T>::squared_residual(const T* x, T* scratch) const noexcept {
  residual(x, scratch);
  double sum = 0.0;
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    const double r = static_cast<double>(scratch[i]);
    sum += static_cast<double>(weights_[i]) * r * r;
  }
  return sum;
}

template class FrameSamples<float>;
template class FrameSamples<double>;

}  // namespace compueye::recon::core
