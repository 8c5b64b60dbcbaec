#include "firmware/doctor/link_quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr std::int64_t patience_ns = 5'000'000'000;

/// Of a time that is about `frames` periods.
double off_us(std::int64_t apart_ns, std::uint64_t frames, double period_ns) noexcept {
  return std::fabs(static_cast<double>(apart_ns) - static_cast<double>(frames) * period_ns) * 1e-3;
}

}  // namespace

double percentile(const std::vector<double>& ascending, double part) noexcept {
  if (ascending.empty()) return 0.0;
  const double rank = std::ceil(part * static_cast<double>(ascending.size()));
  return ascending[static_cast<std::size_t>(std::clamp(rank - 1.0, 0.0, static_cast<double>(ascending.size() - 1)))];
}

std::string histogram(const std::vector<double>& ascending) {
  constexpr std::size_t widest = 40;
  std::string text;
  auto at = ascending.begin();
  for (double decade = 1.0; at != ascending.end(); decade *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double below_us = decade * step;
      const auto end = std::find_if(at, ascending.end(), [&](double value) { return value >= below_us; });
      const auto count = static_cast<std::size_t>(end - at);
      at = end;
      if (count == 0) continue;
      const std::size_t bar = (count * widest + ascending.size() - 1) / ascending.size();
      text += fmt::format("  below {:>7g} us {:>6} {}\n", below_us, count, std::string(bar, '#'));
    }
  }
  return text;
}

hal::Result<LinkQuality> measure_link(hal::SampleSource& eye, hal::Clock& clock, int frames,
                                      const std::function<bool()>& go_on) {
  LinkQuality link;
  const double period_ns = 1e9 / eye.describe().frame_rate_hz;
  link.period_ms = period_ns * 1e-6;
  TRY(eye.start());
  struct Seen {
    std::uint64_t frame;
    std::int64_t t_ns, arrived_ns;
  };
  std::optional<Seen> last;
  const auto ended = [&]() -> hal::Result<void> {
    while (link.frames < frames) {
      if (!go_on()) return hal::fail(hal::ErrorCode::interrupted, "doctor", "was stopped");
      const std::int64_t now_ns = clock.now_ns();
      const auto block = eye.read(now_ns + static_cast<std::int64_t>(20.0 * period_ns) + patience_ns);
      if (!block) return tl::unexpected(block.error());
      const Seen seen{block->frame, block->t_ns, clock.now_ns()};
      if (last && block->flags.time_ok) {
        const std::uint64_t passed = seen.frame - last->frame;
        link.exposure_jitter_us.push_back(off_us(seen.t_ns - last->t_ns, passed, period_ns));
        link.arrival_jitter_us.push_back(off_us(seen.arrived_ns - last->arrived_ns, passed, period_ns));
      }
      last = seen;
      ++link.frames;
    }
    return {};
  }();
  eye.stop();
  link.account = eye.account();
  link.counters = eye.counters();
  TRY(ended);
  std::ranges::sort(link.exposure_jitter_us);
  std::ranges::sort(link.arrival_jitter_us);
  return link;
}

}  // namespace compueye::firmware
