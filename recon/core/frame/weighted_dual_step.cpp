#include "recon/core/frame/weighted_dual_step.hpp"

#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double least_weight = 1e-6;

}  // namespace

template <class T>
WeightedDualStep<T>::WeightedDualStep(const FrameProblem<T>& problem, const DeflatedStep<T>& step, T relaxation,
                                      Workspace& workspace) noexcept
    : deflated_(&step),
      relaxation_(relaxation),
      seeing_(problem.a.rows),
      samples_(problem, workspace),
      residual_(workspace.take<T>(problem.a.rows)),
      step_(workspace.take<T>(problem.a.rows)),
      reweighted_(problem.max_reweighted, is_tall(problem.a) ? step.parts[0].rank : 0, workspace),
      scratch_(workspace.take<T>(step.scratch_size())) {}

template <class T>
bool WeightedDualStep<T>::begin(const float* y, const float* weights) noexcept {
  return samples_.gather(y, weights) && reweighted_.list(samples_) && factor_substitution();
}

template <class T>
bool WeightedDualStep<T>::factor_substitution() noexcept {
  const std::size_t n = reweighted_.count(), *rows = reweighted_.rows();
  if (!reweighted_.by_modes()) restrict_to(*deflated_, rows, n, reweighted_.matrix(), scratch_);
  for (std::size_t s = 0; s < n; ++s) {
    const double weight = static_cast<double>(samples_.weights()[rows[s]]);
    const double added = is_missing(rows[s]) ? 0.0 : weight / (1.0 - weight);
    if (reweighted_.by_modes()) {
      reweighted_.diagonal()[s] = static_cast<double>(deflated_->parts[0].rest[0]) + added;
      read_modes(deflated_->parts[0], rows[s], reweighted_.modes(s));
    } else if (added > 0.0) {
      reweighted_.matrix()[s * n + s] += added;
    }
  }
  return reweighted_.factor();
}

template <class T>
void WeightedDualStep<T>::apply(const T* x, T* u) noexcept {
  const std::size_t rows = seeing_;
  samples_.forward(x, residual_);
  add_dual_to_residual(samples_.values(), samples_.weights(), u, residual_, rows);
  for (std::size_t s = 0; s < reweighted_.count(); ++s) {
    const std::size_t i = reweighted_.rows()[s];
    residual_[i] = is_missing(i) ? T(0) : flushed(residual_[i] + (u[i] / samples_.weights()[i] - u[i]));
  }
  core::apply(*deflated_, level_, residual_, step_, scratch_);
  if (reweighted_.count() > 0) {
    for (std::size_t s = 0; s < reweighted_.count(); ++s) {
      reweighted_.values()[s] = static_cast<double>(step_[reweighted_.rows()[s]]);
    }
    reweighted_.replace(residual_);
    core::apply(*deflated_, level_, residual_, step_, scratch_);
  }
  step_down(step_, relaxation_, u, rows);
  for (std::size_t s = 0; s < reweighted_.count(); ++s) {
    if (is_missing(reweighted_.rows()[s])) u[reweighted_.rows()[s]] = T(0);
  }
}

template <class T>
bool WeightedDualStep<T>::is_missing(std::size_t row) const noexcept {
  return static_cast<double>(samples_.weights()[row]) < least_weight;
}

template <class T>
double WeightedDualStep<T>::squared_size(const T* r) noexcept {
  core::apply(*deflated_, 0, r, step_, scratch_);
  return static_cast<double>(dot(r, step_, seeing_));
}

template class WeightedDualStep<float>;
template class WeightedDualStep<double>;

}  // namespace compueye::recon::core
