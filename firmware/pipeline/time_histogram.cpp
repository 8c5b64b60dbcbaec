#include "firmware/pipeline/time_histogram.hpp"

#include <algorithm>
#include <bit>

namespace compueye::firmware {

std::size_t TimeHistogram::bucket_of(std::int64_t ns) noexcept {
  const auto value = static_cast<std::uint64_t>(ns);
  if (value < (1U << exact_bits)) return static_cast<std::size_t>(value);
  const int exponent = static_cast<int>(std::bit_width(value)) - 1;
  const std::uint64_t sub = (value >> (exponent - sub_bits)) & ((1U << sub_bits) - 1);
  return (1U << exact_bits) + static_cast<std::size_t>(exponent - exact_bits) * (1U << sub_bits) +
         static_cast<std::size_t>(sub);
}

std::int64_t TimeHistogram::middle_of(std::size_t bucket) noexcept {
  if (bucket < (1U << exact_bits)) return static_cast<std::int64_t>(bucket);
  const std::size_t above = bucket - (1U << exact_bits);
  const int exponent = exact_bits + static_cast<int>(above >> sub_bits);
  const std::uint64_t sub = above & ((1U << sub_bits) - 1);
  const std::uint64_t width = std::uint64_t{1} << (exponent - sub_bits);
  const std::uint64_t low = (std::uint64_t{1} << exponent) + sub * width;
  return static_cast<std::int64_t>(low + width / 2);
}

void TimeHistogram::add(std::int64_t ns) noexcept {
  const std::int64_t value = std::max<std::int64_t>(ns, 0);
  min_ = count_ == 0 ? value : std::min(min_, value);
  max_ = std::max(max_, value);
  ++count_;
  ++counts_[bucket_of(value)];
}

std::int64_t TimeHistogram::percentile(std::uint64_t percent) const noexcept {
  // Split so that the product cannot overflow; the rank is from 1.
  const std::uint64_t rank = (count_ / 100) * percent + ((count_ % 100) * percent + 99) / 100;
  std::uint64_t seen = 0;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    seen += counts_[bucket];
    if (seen >= rank && seen > 0) return std::clamp(middle_of(bucket), min_, max_);
  }
  return max_;
}

TimeStatistics TimeHistogram::statistics() const noexcept {
  if (count_ == 0) return {};
  return {count_, min_, percentile(50), percentile(90), percentile(99), max_};
}

}  // namespace compueye::firmware
