#pragma once

#include <string>
#include <vector>

namespace compueye::firmware {

/// One axis of a plot: its words with their unit, and the range that it shows.
struct Axis {
  std::string label;
  double lo = 0.0, hi = 1.0;

  /// Wide enough for values up to `value`; those that are not finite change nothing.
  void hold(double value) noexcept;
  /// A little room at both ends, and more than nothing between them.
  void settle() noexcept;
  /// Of [0, 1] over the range.
  [[nodiscard]] double share(double value) const noexcept { return (value - lo) / (hi - lo); }
  /// At 1, 2 or 5 times a power of ten: `wanted` of them, about.
  [[nodiscard]] std::vector<double> ticks(int wanted = 6) const;
};

/// That holds nothing yet.
[[nodiscard]] Axis empty_axis(std::string label);

/// Short enough to stand at a tick: "0.05", "2e-05", "20,000".
[[nodiscard]] std::string tick_text(double value);

}  // namespace compueye::firmware
