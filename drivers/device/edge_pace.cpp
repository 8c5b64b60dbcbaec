#include "drivers/device/edge_pace.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace compueye::device {
namespace {

constexpr double grid_gain = 1.0 / 8, period_gain = 1.0 / 64;
constexpr double most_off = 0.01;  // of the stated period
// Two crystals of 250 ppm each are a half period apart behind so many.
constexpr std::uint64_t told_by_time = 1000;
constexpr std::uint64_t most_spurious = 2;  // between two frames

}  // namespace

void EdgePace::begin(std::int64_t period_ns) noexcept {
  stated_ns_ = period_ns_ = static_cast<double>(std::max<std::int64_t>(period_ns, 1));
  begun_ = false;
  number_.reset();
  spurious_ = 0;
}

EdgePace::Seen EdgePace::saw(const hal::Edge& edge) noexcept {
  const auto t_ns = static_cast<double>(edge.t_ns);
  Seen seen;
  if (!begun_) {
    begun_ = seen.frame = true;
    grid_ns_ = t_ns;
    number_ = edge.number;
    return seen;
  }
  // Edges that the kernel has counted behind the last one that it gave.
  const std::uint64_t untaken = number_ && edge.number && *edge.number > *number_ ? *edge.number - *number_ - 1 : 0;
  const bool counted = number_ && edge.number;
  number_ = edge.number;
  const double ratio = (t_ns - grid_ns_) / period_ns_;
  if (ratio < 0.5) {
    seen.spurious = 1 + untaken;
    spurious_ += seen.spurious;
    return seen;
  }
  seen.frame = true;
  std::uint64_t passed = static_cast<std::uint64_t>(std::llround(ratio));
  const std::uint64_t by_number = untaken + 1;
  const std::uint64_t apart = by_number > passed ? by_number - passed : passed - by_number;
  if (counted && apart <= passed / told_by_time) passed = by_number;
  const std::uint64_t before = passed - 1;
  seen.late = std::min(untaken, before);
  seen.unsaid = before - seen.late;
  seen.spurious = untaken - seen.late;
  if (passed > told_by_time && passed != by_number) seen.estimated = before;
  seen.unclear = std::exchange(spurious_, 0) + seen.spurious > most_spurious;
  if (seen.unclear) {
    grid_ns_ += static_cast<double>(passed) * period_ns_;
    return seen;
  }
  const double off_ns = t_ns - (grid_ns_ + static_cast<double>(passed) * period_ns_);
  grid_ns_ = t_ns - off_ns * (1.0 - grid_gain);
  period_ns_ = std::clamp(period_ns_ + off_ns / static_cast<double>(passed) * period_gain,
                          stated_ns_ * (1.0 - most_off), stated_ns_ * (1.0 + most_off));
  return seen;
}

std::uint64_t EdgePace::unseen(std::int64_t t_ns) const noexcept {
  const double passed = begun_ ? (static_cast<double>(t_ns) - grid_ns_) / period_ns_ : 0.0;
  return passed < 1.0 ? 0 : static_cast<std::uint64_t>(passed);
}

std::optional<std::int64_t> EdgePace::next_ns() const noexcept {
  if (!begun_) return std::nullopt;
  return static_cast<std::int64_t>(grid_ns_ + period_ns_);
}

}  // namespace compueye::device
