#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace compueye::recon {

struct ChannelDetectorSettings {
  double sigma = 0.0;     ///< noise of a sample in units of y, >= 0
  std::size_t most = 0;   ///< channels that may be masked at a time
  double outlier = 8.0;   ///< scales that a channel is off by; sound ones stay below 5.1 on every scene and board
  double share = 0.02;    ///< and of what its neighbours read: less harms no picture
  int looks = 2;          ///< in a row that it must be off to be masked
  int healthy_looks = 8;  ///< in a row that a masked one must be right again; twice as many after every relapse ...
  int most_looks = 1024;  ///< ... up to so many
};

/// Finds dead, stuck and hot channels nobody has told of: what they read does not follow what the picture made from the
/// others predicts. A channel's residual y - A x is taken against the median of those of its neighbours on the lattice
/// (an unfinished solve leaves smooth ones), and measured by the median of all such differences, or sigma if that is
/// more. Whoever is off most among its neighbours for some frames is masked, so that neighbours whom it pulls with it
/// are not. When more channels are off than may be masked at all, it is the response that does not fit or a solver that
/// is far from done: nobody is masked then. Pure: same frames, same masks. Allocates at construction only.
class ChannelDetector {
 public:
  /// Channels by ommatidium on a lattice, row-major; `sees` 0 = blind or known to be dead.
  ChannelDetector(int lattice_rows, int lattice_columns, std::span<const std::uint8_t> sees,
                  const ChannelDetectorSettings& settings);

  /// A frame that was solved without the masked channels: samples, the residuals of all of them, and weights 0 of those
  /// that have no sample in this frame. True when a channel was masked: what was solved so far is tainted by it.
  bool look(std::span<const float> y, std::span<const float> residuals, std::span<const float> weights) noexcept;

  /// By ommatidium, 1 = masked now.
  [[nodiscard]] std::span<const std::uint8_t> masked() const noexcept { return masked_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Looks at which more channels were off than may be masked.
  [[nodiscard]] std::uint64_t crowded() const noexcept { return crowded_; }
  [[nodiscard]] std::uint64_t found() const noexcept { return found_; }          ///< times that one was masked
  [[nodiscard]] std::uint64_t recovered() const noexcept { return recovered_; }  ///< times that one was unmasked

 private:
  static constexpr int reach = 2;

  [[nodiscard]] bool in_use(std::size_t m, std::span<const float> weights) const noexcept {
    return sees_[m] != 0 && weights[m] > 0.0F;
  }
  template <class Visit>
  void for_each_neighbour(std::size_t m, Visit&& visit) const;
  [[nodiscard]] float median_around(std::size_t m, std::span<const float> of, std::span<const float> weights) noexcept;
  [[nodiscard]] double measure(std::span<const float> residuals, std::span<const float> weights) noexcept;
  [[nodiscard]] bool leads(std::size_t m, std::span<const float> weights) const noexcept;
  [[nodiscard]] bool mask_suspects() noexcept;
  void unmask_healthy(double scale, std::span<const float> weights) noexcept;

  int rows_, columns_;
  ChannelDetectorSettings settings_;
  std::vector<std::uint8_t> sees_, masked_, off_;
  std::vector<float> apart_;    // residual less that of the neighbours
  std::vector<float> scratch_;  // values whose median is taken
  std::vector<int> off_looks_, healthy_looks_, wanted_looks_;
  std::size_t count_ = 0;
  std::uint64_t crowded_ = 0, found_ = 0, recovered_ = 0;
};

}  // namespace compueye::recon
