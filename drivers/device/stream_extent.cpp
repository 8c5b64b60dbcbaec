#include "drivers/device/stream_extent.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "drivers/protocol/requests.hpp"

namespace compueye::device {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// STATUS counts modulo 2^32: the number near `estimate`; nothing when there is none, 0 .. `most`.
std::optional<std::uint64_t> near_estimate(std::uint32_t counted, std::uint64_t estimate, std::uint64_t most) noexcept {
  const std::int64_t ahead = static_cast<std::int32_t>(counted - static_cast<std::uint32_t>(estimate));
  if (-ahead > static_cast<std::int64_t>(estimate)) return std::nullopt;
  const std::uint64_t number = estimate + static_cast<std::uint64_t>(ahead);
  if (number > most) return std::nullopt;
  return number;
}

}  // namespace

void ExposureClock::begin(std::int64_t start_ns, std::int64_t period_ns) noexcept {
  *this = {};
  origin_ns_ = start_ns;
  period_ns_ = std::max<std::int64_t>(period_ns, 1);
}

void ExposureClock::saw_frame(std::uint64_t device_frame, std::int64_t now_ns, bool waited_for) noexcept {
  std::int64_t ready_ns = 0;
  if (device_frame >= static_cast<std::uint64_t>(none) ||
      __builtin_mul_overflow(static_cast<std::int64_t>(device_frame) + 1, period_ns_, &ready_ns) ||
      __builtin_add_overflow(ready_ns, origin_ns_, &ready_ns)) {
    return;  // no device has run for so long
  }
  std::int64_t late_ns = now_ns - ready_ns;
  if (late_ns < 0) {
    origin_ns_ += late_ns;
    late_ns = 0;
  }
  if (!waited_for) return;
  least_in_window_ns_ = std::min(least_in_window_ns_, late_ns);
  if (++in_window_ < window) return;
  if (least_late_ns_ != none && least_in_window_ns_ > least_late_ns_) {
    origin_ns_ += least_in_window_ns_ - least_late_ns_;
  } else {
    least_late_ns_ = least_in_window_ns_;
  }
  least_in_window_ns_ = none;
  in_window_ = 0;
}

std::uint64_t ExposureClock::exposed_before(std::int64_t t_ns) const noexcept {
  return t_ns <= origin_ns_ ? 0 : static_cast<std::uint64_t>((t_ns - origin_ns_ - 1) / period_ns_);
}

void StreamExtent::begin(std::uint32_t config_id, const protocol::Status& before, std::int64_t start_ns,
                         std::int64_t period_ns) noexcept {
  open_ = true;
  idle_ = gone_ = false;
  come_ = 0;
  come_ns_ = start_ns;
  period_ns_ = std::max<std::int64_t>(period_ns, 1);
  config_id_ = config_id;
  before_ = before;
  gone_ns_ = stopped_ns_ = quiet_ns_ = never;
  clock_.begin(start_ns, period_ns);
}

std::uint64_t StreamExtent::unseen(std::int64_t now_ns) const noexcept {
  const std::uint64_t exposed = clock_.exposed_before(now_ns);
  return exposed > come_ ? exposed - come_ : 0;
}

std::uint64_t StreamExtent::most_exposed(std::int64_t now_ns) const noexcept {
  const auto of_latency = static_cast<std::uint64_t>(protocol::control_deadline_ns / period_ns_);
  return clock_.exposed_before(now_ns) + 2 + of_latency + unseen(now_ns) / 16;
}

StreamExtent::Frames StreamExtent::close(const protocol::Status& status, std::int64_t now_ns) noexcept {
  open_ = false;
  // One that has started anew has no configuration, unless it did so before it got this one.
  const bool anew = status.boot_count != before_.boot_count;
  if (anew && status.config_id != config_id_) {
    const auto up_ns = static_cast<std::int64_t>(std::min(status.now_ns, static_cast<std::uint64_t>(never)));
    const std::int64_t end_ns = std::min({gone_ns_, stopped_ns_, now_ns - up_ns});
    const bool once = status.boot_count == before_.boot_count + 1;
    if (!once && end_ns - 2 * period_ns_ > come_ns_) return {come_, 0, true};
    return {clock_.exposed_before(end_ns), 0, true};
  }
  // The counters of the stream before: START did not arrive.
  const bool untouched = !anew && status.frames == before_.frames && status.last_t_ns == before_.last_t_ns;
  if (status.config_id != config_id_ || untouched) return {};
  const std::uint64_t estimate = clock_.exposed_before(now_ns);
  const auto counted = near_estimate(status.frames, estimate, most_exposed(now_ns));
  return {counted.value_or(estimate), status.overruns, !counted};
}

StreamExtent::Frames StreamExtent::close(std::int64_t now_ns) noexcept {
  open_ = false;
  for (const std::int64_t end_ns : {std::min(gone_ns_, idle_ ? never : stopped_ns_), quiet_ns_}) {
    if (end_ns != never) return {clock_.exposed_before(end_ns), 0, true};
  }
  return {clock_.exposed_before(now_ns), 0, true};
}

}  // namespace compueye::device
