#include "recon/core/frame/reweighted_channels.hpp"

#include "recon/core/parts/cholesky.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

template <class T>
ReweightedChannels<T>::ReweightedChannels(std::size_t most, std::size_t rank, Workspace& workspace) noexcept
    : most_(most),
      rank_(rank < most ? rank : 0),
      rows_(workspace.take<std::size_t>(most)),
      matrix_(workspace.take<double>(rank_ > 0 ? rank_ * rank_ : most * most)),
      values_(workspace.take<double>(most)),
      diagonal_(workspace.take<double>(rank_ > 0 ? most : 0)),
      modes_(workspace.take<double>(rank_ * most)),
      along_(workspace.take<double>(rank_)) {}

template <class T>
bool ReweightedChannels<T>::list(const FrameSamples<T>& samples) noexcept {
  count_ = 0;
  if (samples.channels_reweighted() > most_) return false;
  for (std::size_t i = 0; count_ < samples.channels_reweighted(); ++i) {
    if (samples.weights()[i] != T(1)) rows_[count_++] = i;
  }
  return true;
}

template <class T>
bool ReweightedChannels<T>::factor() noexcept {
  if (count_ == 0) return true;
  if (!by_modes()) return cholesky_factor(matrix_, count_);
  for (std::size_t k = 0; k < rank_ * rank_; ++k) matrix_[k] = 0.0;
  for (std::size_t k = 0; k < rank_; ++k) matrix_[k * rank_ + k] = 1.0;
  for (std::size_t s = 0; s < count_; ++s) {
    const double* v = modes(s);
    for (std::size_t k = 0; k < rank_; ++k) accumulate(v, -v[k] / diagonal_[s], matrix_ + k * rank_, k + 1);
  }
  return cholesky_factor(matrix_, rank_);
}

template <class T>
void ReweightedChannels<T>::solve() noexcept {
  if (!by_modes()) return cholesky_solve(matrix_, count_, values_);
  for (std::size_t k = 0; k < rank_; ++k) along_[k] = 0.0;
  for (std::size_t s = 0; s < count_; ++s) accumulate(modes(s), values_[s] / diagonal_[s], along_, rank_);
  cholesky_solve(matrix_, rank_, along_);
  for (std::size_t s = 0; s < count_; ++s) values_[s] = (values_[s] + dot(modes(s), along_, rank_)) / diagonal_[s];
}

template <class T>
void ReweightedChannels<T>::replace(T* residual) noexcept {
  solve();
  for (std::size_t s = 0; s < count_; ++s) residual[rows_[s]] -= static_cast<T>(values_[s]);
}

template class ReweightedChannels<float>;
template class ReweightedChannels<double>;

}  // namespace compueye::recon::core
