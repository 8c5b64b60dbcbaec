#include "firmware/sinks/live_status.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace compueye::firmware {

void LiveStatus::published(std::uint64_t frame, std::int64_t age_ns, bool late) noexcept {
  constexpr auto relaxed = std::memory_order_relaxed;
  const std::uint64_t numbered = frame + 1, published = delivered_.fetch_add(1, relaxed) + 1;
  // Some of the last check may be counted whose numbers are still to come: never too few, and right when it is over.
  const std::uint64_t known = published + (checked_ == nullptr ? 0 : checked_->load(relaxed));
  if (numbered > known && numbered - known > dropped_.load(relaxed)) {
    dropped_.store(numbered - known, relaxed);
    gaps_.fetch_add(1, relaxed);
  }
  late_.fetch_add(late ? 1 : 0, relaxed);
  age_ns_.store(age_ns, relaxed);
}

void LiveStatus::source_is(std::uint64_t faults, bool recovering) noexcept {
  faults_.store(faults, std::memory_order_relaxed);
  recovering_.store(recovering, std::memory_order_relaxed);
}

void StatusLine::count(std::uint64_t delivered, std::int64_t now_ns) noexcept {
  constexpr std::int64_t window_ns = 1'000'000'000;
  if (begun_ && delivered != heard_) frame_took_ns_ = now_ns - heard_ns_;
  if (!begun_ || delivered != heard_) heard_ns_ = now_ns;
  heard_ = delivered;
  const std::int64_t since_ns = now_ns - counted_ns_;
  if (begun_ && since_ns < window_ns) return;
  if (begun_) rate_hz_ = static_cast<double>(delivered - counted_) * 1e9 / static_cast<double>(since_ns);
  begun_ = true;
  counted_ns_ = now_ns;
  counted_ = delivered;
}

std::string_view StatusLine::print(std::int64_t now_ns, std::span<char> room) noexcept {
  constexpr std::int64_t silence_ns = 1'000'000'000;
  const std::uint64_t delivered = status_->delivered();
  count(delivered, now_ns);
  const std::int64_t silent_ns = now_ns - heard_ns_;
  const bool silent = silent_ns >= std::max(silence_ns, 3 * frame_took_ns_), recovering = status_->recovering();
  if (room.empty() || (delivered == 0 && !silent && !recovering)) return {};
  char now[96];
  if (silent || recovering) {
    const char* why = recovering ? "recovering, " : status_->checking() ? "checking the eye, " : "";
    std::snprintf(now, sizeof now, "%ssilent %.1f s", why, static_cast<double>(silent_ns) * 1e-9);
  } else {
    char rate[32] = "-";
    if (rate_hz_ >= 0.0) std::snprintf(rate, sizeof rate, "%.1f", rate_hz_);
    std::snprintf(now, sizeof now, "%s/s, age %.0f ms", rate, static_cast<double>(status_->age_ns()) * 1e-6);
  }
  char fit[48] = "", dead[48] = "";
  if (const std::uint64_t out = status_->left_out(); out > 0) {
    std::snprintf(dead, sizeof dead, ", %" PRIu64 " channel%s left out", out, out == 1 ? "" : "s");
  }
  if (const double misfit = status_->misfit(); misfit > 0.0) {
    std::snprintf(fit, sizeof fit, ", residual %.0f x noise", misfit);
  }
  const std::uint64_t gaps = status_->gaps(), faults = status_->faults();
  const int wanted = std::snprintf(
      room.data(), room.size(),
      "%s, %" PRIu64 " dropped in %" PRIu64 " gap%s, %" PRIu64 " late, %" PRIu64 " fault%s%s%s", now,
      status_->dropped(), gaps, gaps == 1 ? "" : "s", status_->late(), faults, faults == 1 ? "" : "s", dead, fit);
  if (wanted < 0) return {};
  return {room.data(), std::min(static_cast<std::size_t>(wanted), room.size() - 1)};
}

}  // namespace compueye::firmware
