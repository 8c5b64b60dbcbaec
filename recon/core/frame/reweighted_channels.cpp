#include "recon/core/frame/reweighted_channels.hpp"

#include "recon/core/parts/cholesky.hpp"

namespace compueye::recon::core {

template <class T>
ReweightedChannels<T>::ReweightedChannels(std::size_t most, Workspace& workspace) noexcept
    : most_(most),
      rows_(workspace.take<std::size_t>(most)),
      matrix_(workspace.take<double>(most * most)),
      values_(workspace.take<double>(most)) {}

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
  return count_ == 0 || cholesky_factor(matrix_, count_);
}

template <class T>
void ReweightedChannels<T>::replace(T* residual) noexcept {
  cholesky_solve(matrix_, count_, values_);
  for (std::size_t s = 0; s < count_; ++s) residual[rows_[s]] -= static_cast<T>(values_[s]);
}

template class ReweightedChannels<float>;
template class ReweightedChannels<double>;

}  // namespace compueye::recon::core
