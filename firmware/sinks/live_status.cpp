#include "firmware/sinks/live_status.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace compueye::firmware {

void LiveStatus::published(std::uint64_t frame, std::int64_t age_ns, bool late) noexcept {
  constexpr auto relaxed = std::memory_order_relaxed;
  if (frame > next_frame_.load(relaxed)) gaps_.fetch_add(1, relaxed);
  next_frame_.store(frame + 1, relaxed);
  delivered_.fetch_add(1, relaxed);
  late_.fetch_add(late ? 1 : 0, relaxed);
  age_ns_.store(age_ns, relaxed);
}

std::uint64_t LiveStatus::dropped() const noexcept {
  const std::uint64_t published = delivered(), numbered = next_frame_.load(std::memory_order_relaxed);
  return numbered > published ? numbered - published : 0;
}

std::string_view StatusLine::print(std::int64_t now_ns, std::span<char> room) noexcept {
  constexpr std::int64_t window_ns = 1'000'000'000;
  const std::uint64_t delivered = status_->delivered();
  const std::int64_t since_ns = now_ns - counted_ns_;
  if (!begun_ || since_ns >= window_ns) {
    if (begun_) rate_hz_ = static_cast<double>(delivered - counted_) * 1e9 / static_cast<double>(since_ns);
    begun_ = true;
    counted_ns_ = now_ns;
    counted_ = delivered;
  }
  if (delivered == 0 || room.empty()) return {};
  char rate[32] = "-";
  if (rate_hz_ >= 0.0) std::snprintf(rate, sizeof rate, "%.1f", rate_hz_);
  const std::uint64_t gaps = status_->gaps();
  const int wanted = std::snprintf(
      room.data(), room.size(), "%s/s, age %.0f ms, %" PRIu64 " dropped in %" PRIu64 " gap%s, %" PRIu64 " late", rate,
      static_cast<double>(status_->age_ns()) * 1e-6, status_->dropped(), gaps, gaps == 1 ? "" : "s", status_->late());
  if (wanted < 0) return {};
  return {room.data(), std::min(static_cast<std::size_t>(wanted), room.size() - 1)};
}

}  // namespace compueye::firmware
