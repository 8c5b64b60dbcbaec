#include "studies/accuracy_and_time/frame_times.hpp"

#include <ctime>

#include <algorithm>
#include <limits>

namespace compueye::firmware {

double FrameTimes::percentile_ms(std::uint64_t per_mille) const {
  if (ns_.empty()) return std::numeric_limits<double>::quiet_NaN();
  constexpr std::uint64_t whole = 1000;
  const std::uint64_t rank = std::clamp<std::uint64_t>((ns_.size() * per_mille + whole - 1) / whole, 1, ns_.size());
  std::vector<std::int64_t> sorted = ns_;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return static_cast<double>(*at) * 1e-6;
}

std::int64_t process_cpu_ns() noexcept {
  constexpr std::int64_t second_ns = 1'000'000'000;
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<std::int64_t>(now.tv_sec) * second_ns + now.tv_nsec;
}

}  // namespace compueye::firmware
