#include "recon/core/frame/warm_start.hpp"

#include <cstring>

#include "recon/core/parts/proximal.hpp"

namespace compueye::recon::core {

template <class T>
WarmStart<T>::WarmStart(const FrameProblem<T>& problem, bool wanted, T rho, Workspace& workspace) noexcept
    : problem_(&problem), rho_(rho) {
  if (!wanted) return;
  mark_ = workspace.take<Mark>(1);
  last_values_ = workspace.take<T>(problem.a.rows);
}

/// Memory that no frame of this problem has written may hold anything; that it holds this by chance is one in 2^64.
template <class T>
std::uint64_t WarmStart<T>::mark_of_problem() const noexcept {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto add = [&hash](const auto& value) {
    unsigned char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211ULL;
  };
  add(reinterpret_cast<std::uintptr_t>(problem_));
  add(problem_->a.rows);
  add(problem_->a.cols);
  add(problem_->psi.kind);
  add(problem_->lambda);
  add(rho_);
  return hash;
}

template <class T>
bool WarmStart<T>::allowed(WeightedDualStep<T>& dual_step) const noexcept {
  if (mark_ == nullptr || mark_->problem != mark_of_problem()) return false;

  const FrameSamples<T>& samples = dual_step.samples();
  const T* values = samples.values();
  T* change = dual_step.row_scratch();
  for (std::size_t i = 0; i < problem_->a.rows; ++i) {
    const bool both = samples.weights()[i] > T(0) && last_values_[i] != T(0);
    change[i] = both ? values[i] - last_values_[i] : T(0);
  }
  flush_tiny(change, problem_->a.rows);
  return dual_step.squared_size(change) <= limit * dual_step.squared_size(values);
}

template <class T>
void WarmStart<T>::keep(const FrameSamples<T>& samples, bool usable) noexcept {
  if (mark_ == nullptr) return;
  mark_->problem = usable ? mark_of_problem() : 0;
  for (std::size_t i = 0; i < problem_->a.rows; ++i) last_values_[i] = samples.values()[i];
}

template <class T>
void WarmStart<T>::forget(std::byte* workspace) noexcept {
  std::memset(workspace, 0, sizeof(Mark));
}

template class WarmStart<float>;
template class WarmStart<double>;

}  // namespace compueye::recon::core
