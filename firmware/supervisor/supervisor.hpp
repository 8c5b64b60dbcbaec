#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/supervisor/health.hpp"
#include "firmware/supervisor/service_manager.hpp"

namespace compueye::firmware {

/// Looks at a run again and again, tells people and the service manager how it gets on, and feeds the watchdog by
/// progress: not while a stage is stuck or fruitless, and always while the source gets its eye back. It has no clock
/// and no thread of its own.
class Supervisor {
 public:
  /// A sentence and its priority, of syslog(3).
  using Say = std::function<void(int priority, const std::string& sentence)>;

  /// `manager` must outlive it. `all`: every change is said, and otherwise only that a restart is needed.
  Supervisor(const HealthLimits& limits, ServiceManager& manager, Say say, bool all);

  /// At least every second, better ten times as often. `line` is how the run goes, for status().
  void look(std::int64_t now_ns, const RunCounters& counters, std::string_view line);
  /// The run is over, or is to be.
  void stop() noexcept;

  /// As of the last look.
  [[nodiscard]] const Health& health() const noexcept { return health_; }
  /// Time between two looks is that of the state the first of them saw.
  [[nodiscard]] std::int64_t spent_ns(PictureState state) const noexcept {
    return spent_ns_[static_cast<std::size_t>(state)];
  }
  /// How often the picture was held or taken away after it had come.
  [[nodiscard]] std::uint64_t interruptions() const noexcept { return interruptions_; }
  /// The longest time without a picture that ended, or has not ended yet.
  [[nodiscard]] std::int64_t longest_gap_ns() const noexcept { return longest_gap_ns_; }

 private:
  void count(std::int64_t now_ns, const Health& health) noexcept;
  void tell_people(std::int64_t now_ns);
  void tell_manager(std::int64_t now_ns, std::string_view line);

  HealthLimits limits_;
  ServiceManager& manager_;
  Say say_;
  bool all_;

  Health health_;
  std::array<std::int64_t, picture_states.size()> spent_ns_{};
  std::uint64_t interruptions_ = 0;
  std::int64_t longest_gap_ns_ = 0;
  std::optional<std::int64_t> looked_ns_, fed_ns_, told_ns_, said_ns_;
  Health said_;
  int gravest_ = 7;  ///< priority of what was said since said_ns_
  bool ready_ = false, stopped_ = false, restart_asked_ = false;
};

}  // namespace compueye::firmware
