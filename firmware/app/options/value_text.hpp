#pragma once

#include <optional>
#include <string_view>

namespace compueye::firmware {

// Values as people type them after an option; nothing when the text is anything else, in part or as a whole.

/// A finite decimal number, "0.5", "-3", "1e-6".
[[nodiscard]] std::optional<double> number_from(std::string_view text) noexcept;

[[nodiscard]] std::optional<long> whole_number_from(std::string_view text) noexcept;

struct PictureSize {
  int rows = 0;  ///< H >= 1
  int cols = 0;  ///< W >= 1
};
/// "16x16", rows first; at most 2^31 - 1 pixels.
[[nodiscard]] std::optional<PictureSize> picture_size_from(std::string_view text) noexcept;

struct Interval {
  double lo = 0.0;
  double hi = 0.0;  ///< > lo
};
/// "0,1"
[[nodiscard]] std::optional<Interval> interval_from(std::string_view text) noexcept;

}  // namespace compueye::firmware
