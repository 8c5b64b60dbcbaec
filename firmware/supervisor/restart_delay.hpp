#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace compueye::firmware {

/// How long a service that failed again and again waits before it begins anew: 0, 1, 2, 4, 8, 16 and then 30 s.
/// systemd of Debian 12 cannot do so by itself (RestartSteps= came with version 254).
[[nodiscard]] constexpr std::int64_t restart_delay_ns(std::uint64_t failures_in_a_row) noexcept {
  constexpr std::int64_t second_ns = 1'000'000'000, most_s = 30;
  if (failures_in_a_row == 0) return 0;
  const std::uint64_t doublings = std::min<std::uint64_t>(failures_in_a_row - 1, 10);
  return std::min(std::int64_t{1} << doublings, most_s) * second_ns;
}

/// A run that went well for so long begins a new count.
inline constexpr std::int64_t went_well_after_ns = 60'000'000'000;

/// The count as a file holds it: a number and a line end. What is no such number is none: 0.
[[nodiscard]] std::string failures_text(std::uint64_t failures);
[[nodiscard]] std::uint64_t failures_in(std::string_view text) noexcept;

}  // namespace compueye::firmware
