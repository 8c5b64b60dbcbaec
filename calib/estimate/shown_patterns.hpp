#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "calib/estimate/captures.hpp"

namespace compueye::calib {

/// What a display makes of a pattern: shown = black_level + (1 - black_level) pattern^gamma.
struct DisplayResponse {
  double gamma = 1.0;
  double black_level = 0.0;
};

/// The patterns as shown, pixel by pixel, since a row needs few pixels of all patterns. Those that judge come last, so
/// that either kind is one range.
class ShownPatterns {
 public:
  ShownPatterns(const Captures& captures, int pixels, const DisplayResponse& display);

  [[nodiscard]] int count() const noexcept { return static_cast<int>(order_.size()); }
  [[nodiscard]] int fitted() const noexcept { return fitted_; }  ///< the first ones; the others are held out
  /// Which of the captures' patterns is the k-th here.
  [[nodiscard]] std::size_t capture(int k) const noexcept { return order_[static_cast<std::size_t>(k)]; }

  /// One pixel in all patterns.
  [[nodiscard]] Eigen::Map<const Eigen::VectorXf> pixel(std::int32_t n) const noexcept {
    return {light_.data() + static_cast<std::ptrdiff_t>(n) * count(), count()};
  }

  /// sum += what a row with these entries reads of each pattern. Entries of nought cost nothing.
  void add(std::span<const std::int32_t> pixels, std::span<const double> entries, Eigen::VectorXd& sum) const;

 private:
  std::vector<std::size_t> order_;
  int fitted_ = 0;
  std::vector<float> light_;  // pixels x patterns
};

}  // namespace compueye::calib
