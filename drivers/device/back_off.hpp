#pragma once

#include <algorithm>
#include <cstdint>

namespace compueye::device {

struct BackOffSettings {
  std::int64_t least_ns = 10'000'000;  ///< > 0: the first pause
  std::int64_t most_ns = 500'000'000;  ///< >= least_ns: pauses double up to this
};

/// Pauses between attempts: each twice as long as the one before, up to a limit.
class BackOff {
 public:
  explicit BackOff(const BackOffSettings& settings) noexcept : settings_(settings), next_ns_(settings.least_ns) {}

  [[nodiscard]] std::int64_t next_ns() noexcept {
    const std::int64_t pause_ns = next_ns_;
    next_ns_ = next_ns_ > settings_.most_ns / 2 ? settings_.most_ns : 2 * next_ns_;
    return std::min(pause_ns, settings_.most_ns);
  }
  void reset() noexcept { next_ns_ = settings_.least_ns; }

 private:
  BackOffSettings settings_;
  std::int64_t next_ns_;
};

}  // namespace compueye::device
