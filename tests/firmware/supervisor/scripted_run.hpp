#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/supervisor/health.hpp"
#include "firmware/supervisor/service_manager.hpp"
#include "firmware/supervisor/supervisor.hpp"

namespace compueye::test {

inline constexpr std::int64_t ms = 1'000'000, second = 1000 * ms;

/// A run at 100 Hz whose clock and troubles are the test's.
struct ScriptedRun {
  std::int64_t now_ns = 7 * second;
  firmware::RunCounters counters;

  ScriptedRun() {
    counters.begun_ns = now_ns;
    for (firmware::StageProgress& stage : counters.stages) stage.since_ns = now_ns;
  }
  firmware::StageProgress& stage(firmware::Stage which) { return counters.stages[static_cast<std::size_t>(which)]; }
  void frame(bool late = false) {
    for (firmware::StageProgress& each : counters.stages) {
      each = {.working = false, .since_ns = now_ns, .longest_ns = 4 * ms, .ended = each.ended + 1};
    }
    if (counters.published > 0) counters.interval_ns = now_ns - counters.published_at_ns;
    counters.published_at_ns = now_ns;
    ++counters.published;
    counters.late_bits = (counters.late_bits << 1U) | (late ? 1U : 0U);
  }
  void frames(int count, std::int64_t period_ns = 10 * ms, bool late = false) {
    for (int i = 0; i < count; ++i) {
      now_ns += period_ns;
      frame(late);
    }
  }
  [[nodiscard]] firmware::Health health(const firmware::HealthLimits& limits = {}) const {
    return firmware::assess(limits, now_ns, counters);
  }
};

/// What a service manager heard, a word each.
class HeardManager final : public firmware::ServiceManager {
 public:
  explicit HeardManager(std::int64_t watchdog_ns) : watchdog_ns_(watchdog_ns) {}
  [[nodiscard]] std::int64_t watchdog_ns() const noexcept override { return watchdog_ns_; }
  void starting(std::int64_t /*at_most_ns*/, std::string_view /*doing*/) noexcept override { hear("starting"); }
  void ready() noexcept override { hear("ready"); }
  void status(std::string_view line) noexcept override { last_status = line; }
  void alive() noexcept override {
    ++fed;
    if (heard.empty() || heard.back() != "alive") hear("alive");
  }
  void restart_me() noexcept override { hear("restart"); }
  void stopping() noexcept override { hear("stopping"); }

  std::vector<std::string> heard;
  std::string last_status;
  int fed = 0;

 private:
  void hear(const char* word) { heard.emplace_back(word); }
  std::int64_t watchdog_ns_;
};

}  // namespace compueye::test
