#pragma once

#include <optional>
#include <vector>

namespace compueye::firmware {

/// Of many numbers the one in the middle, and those that a twentieth stays below and above.
struct Spread {
  double low = 0.0, median = 0.0, high = 0.0;
  std::size_t count = 0;  ///< of numbers that there were
};

/// NaN and infinities count for nothing; nothing of none.
[[nodiscard]] std::optional<Spread> spread_of(std::vector<double> values);

}  // namespace compueye::firmware
