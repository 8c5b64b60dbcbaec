#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace compueye::firmware {

/// Of a set of durations in ns; all zero when count is. min and max are exact, the percentiles (nearest rank) within
/// 1.6 %.
struct TimeStatistics {
  std::uint64_t count = 0;
  std::int64_t min_ns = 0;
  std::int64_t median_ns = 0;
  std::int64_t p90_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t max_ns = 0;
};

/// Counts durations in a fixed table, so that a run of any length fits and nothing is allocated: exact below 64 ns,
/// then 32 buckets for every factor of two.
class TimeHistogram {
 public:
  /// Negative durations (a clock that went back) count as 0.
  void add(std::int64_t ns) noexcept;
  [[nodiscard]] TimeStatistics statistics() const noexcept;
  void clear() noexcept { *this = TimeHistogram{}; }

 private:
  static constexpr int exact_bits = 6;
  static constexpr int sub_bits = 5;
  static constexpr std::size_t buckets = (1U << exact_bits) + (63 - exact_bits) * (1U << sub_bits);

  [[nodiscard]] static std::size_t bucket_of(std::int64_t ns) noexcept;
  [[nodiscard]] static std::int64_t middle_of(std::size_t bucket) noexcept;
  [[nodiscard]] std::int64_t percentile(std::uint64_t percent) const noexcept;

  std::array<std::uint64_t, buckets> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t min_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace compueye::firmware
