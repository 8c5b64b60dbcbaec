#pragma once

#include <cstddef>

#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// The seeing channels S whose weight is not one in this frame, and Woodbury's identity for them: a matrix G that was
/// made for weights of one serves all others when the residual r at S is replaced,
///
///   G_W r = G (r - E_S c),  (G_SS + D) c = (G r)_S
///
/// with a diagonal D that depends on what the weights do to G^-1.
template <class T>
class ReweightedChannels {
 public:
  ReweightedChannels(std::size_t most, Workspace& workspace) noexcept;

  /// Lists the channels of a frame; false when they are more than planned.
  [[nodiscard]] bool list(const FrameSamples<T>& samples) noexcept;

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Positions among the seeing rows, ascending; count() of them.
  [[nodiscard]] const std::size_t* rows() const noexcept { return rows_; }
  /// G_SS + D, count() x count() row-major, of which the lower triangle is read: to be filled in before factor().
  [[nodiscard]] double* matrix() noexcept { return matrix_; }
  [[nodiscard]] bool factor() noexcept;

  /// (G r)_S, count() of them: to be filled in before replace().
  [[nodiscard]] double* values() noexcept { return values_; }
  /// r -= E_S c
  void replace(T* residual) noexcept;

 private:
  std::size_t most_;
  std::size_t count_ = 0;
  std::size_t* rows_;
  double* matrix_;
  double* values_;
};

extern template class ReweightedChannels<float>;
extern template class ReweightedChannels<double>;

}  // namespace compueye::recon::core
