#pragma once

#include <cstdint>

namespace compueye::firmware {

/// When what is said. Times in ns, > 0.
struct HealthLimits {
  /// Since the last picture. Pictures that come seldom are given three and ten times what they last took to come.
  std::int64_t held_after_ns = 250'000'000;
  std::int64_t blank_after_ns = 2'000'000'000;
  /// Of one piece of work. A stage that has already taken longer is given four times that; one that has ended none yet
  /// is given ten times this.
  std::int64_t stuck_after_ns = 10'000'000'000;
  std::int64_t fruitless_after_ns = 10'000'000'000;
  /// Late are pictures of which so many of the last 32 were.
  int late_of_32 = 8;
};

}  // namespace compueye::firmware
