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
/// with a diagonal D that depends on what the weights do to G^-1. Where G is known by `rank` modes, far fewer than
/// channels, G_SS + D = E - V V' with a diagonal E and V as many columns, and Woodbury's identity once more takes a
/// matrix of that order in place of one of the channels:
///
///   (E - V V')^-1 = E^-1 + E^-1 V (I - V' E^-1 V)^-1 V' E^-1
template <class T>
class ReweightedChannels {
 public:
  /// By modes where they are fewer than `most`; `rank` 0: never.
  ReweightedChannels(std::size_t most, std::size_t rank, Workspace& workspace) noexcept;

  /// Lists the channels of a frame; false when they are more than planned.
  [[nodiscard]] bool list(const FrameSamples<T>& samples) noexcept;

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Positions among the seeing rows, ascending; count() of them.
  [[nodiscard]] const std::size_t* rows() const noexcept { return rows_; }
  [[nodiscard]] bool by_modes() const noexcept { return rank_ > 0; }
  /// G_SS + D, count() x count() row-major, of which the lower triangle is read: to be filled in before factor().
  [[nodiscard]] double* matrix() noexcept { return matrix_; }
  /// By modes, in its place: E, count() of them, and row `channel` of V.
  [[nodiscard]] double* diagonal() noexcept { return diagonal_; }
  [[nodiscard]] double* modes(std::size_t channel) noexcept { return modes_ + channel * rank_; }
  [[nodiscard]] bool factor() noexcept;

  /// (G r)_S, count() of them: to be filled in before solve() or replace(), which make it c.
  [[nodiscard]] double* values() noexcept { return values_; }
  void solve() noexcept;
  /// r -= E_S c
  void replace(T* residual) noexcept;

 private:
  std::size_t most_;
  std::size_t rank_;
  std::size_t count_ = 0;
  std::size_t* rows_;
  double* matrix_;
  double* values_;
  double* diagonal_;
  double* modes_;
  double* along_;  // the modes
};

extern template class ReweightedChannels<float>;
extern template class ReweightedChannels<double>;

}  // namespace compueye::recon::core
