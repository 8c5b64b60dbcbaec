#include "recon/core/frame/residual_copy.hpp"

#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

/// Below this a channel bounds nothing that float32 could tell.
constexpr double least_weight = 1e-12;

}  // namespace

template <class T>
ResidualCopy<T>::ResidualCopy(const FactoredProblem<T>& problem, Workspace& workspace) noexcept : problem_(problem) {
  residual_ = workspace.take<T>(problem.a.rows);
  dual_ = workspace.take<T>(problem.a.rows);
  near_ = workspace.take<T>(problem.a.rows);
  shift_ = workspace.take<T>(problem.a.rows);
  root_weight_ = workspace.take<T>(problem.a.rows);
}

template <class T>
void ResidualCopy<T>::begin(const FrameSamples<T>& samples, T penalty) noexcept {
  penalty_ = penalty;
  for (std::size_t i = 0; i < problem_.a.rows; ++i) {
    const double weight = static_cast<double>(samples.weights()[i]);
    root_weight_[i] = weight < least_weight ? T(0) : static_cast<T>(square_root(weight));
    residual_[i] = dual_[i] = T(0);
  }
}

template <class T>
const T* ResidualCopy<T>::shift() noexcept {
  const std::size_t rows = problem_.a.rows;
  for (std::size_t i = 0; i < rows; ++i) near_[i] = residual_[i] + dual_[i];
  T share = T(1) / (T(1) + penalty_);
  if (problem_.bounded) {
    const double size = square_root(static_cast<double>(dot(near_, near_, rows)));
    const double epsilon = static_cast<double>(problem_.epsilon);
    share = size > epsilon ? static_cast<T>(epsilon / size) : T(1);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    near_[i] *= share;
    shift_[i] = root_weight_[i] > T(0) ? (near_[i] - dual_[i]) / root_weight_[i] : T(0);
  }
  return shift_;
}

template <class T>
void ResidualCopy<T>::update(const T* correction, T step) noexcept {
  const std::size_t rows = problem_.a.rows;
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(root_weight_[i] > T(0))) continue;
    const T dual = problem_.rho * correction[i] / root_weight_[i];
    const T moved = near_[i] - dual_[i] + dual;
    residual_[i] += step * (moved - residual_[i]);
    dual_[i] = dual;
  }
  flush_tiny(residual_, rows);
  flush_tiny(dual_, rows);
}

template class ResidualCopy<float>;
template class ResidualCopy<double>;

}  // namespace compueye::recon::core
