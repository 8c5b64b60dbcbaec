#include <cmath>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"

namespace compueye::firmware {
namespace {

using V = SettingValue;

constexpr double ms = 1e6, s = 1e9;

/// A limit in ns, told in a longer unit.
template <std::int64_t HealthLimits::*member, const double& unit_ns>
Row limit(std::string_view key, std::string_view meaning) {
  return Row(key, meaning)
      .of(SettingType::real)
      .stored([](Board& board, const V& value) { board.health.*member = std::llround(real_of(value) * unit_ns); },
              [](const Board& board) { return value_of(static_cast<double>(board.health.*member) / unit_ns); });
}

}  // namespace

std::vector<Setting> service_settings() {
  std::vector<Setting> all;
  add(all, "health",
      {limit<&HealthLimits::held_after_ns, ms>(
           "held_after_ms",
           "without a new picture the last one is held; three times what the last took to come, if "
           "that is longer")
           .within({1, 3600e3})
           .otherwise(250),
       limit<&HealthLimits::blank_after_ns, ms>(
           "blank_after_ms",
           "without a new picture the last one is taken away; ten times what it took to come, if "
           "that is longer")
           .within({1, 3600e3})
           .otherwise(2000),
       limit<&HealthLimits::stuck_after_ns, s>(
           "stuck_after_s",
           "at one piece of work a stage is stuck, which needs a restart; four times its longest so "
           "far, if that is longer, and ten times this for its first")
           .within({0.1, 86400})
           .otherwise(10),
       limit<&HealthLimits::fruitless_after_ns, s>(
           "fruitless_after_s", "of frames that a stage throws away as faulty, every one, a restart is needed")
           .within({0.1, 86400})
           .otherwise(10),
       field<&Board::health, &HealthLimits::late_of_32>(
           "late_of_32", "pictures of the last 32 past the deadline make the picture late")
           .within({1, 32})
           .otherwise(8)});
  add(all, "realtime",
      {field<&Board::realtime, &RealtimeSettings::priority>(
           "priority", "of the thread that reads the eye, SCHED_FIFO; 0: as any other")
           .within({0, 99})
           .otherwise(0),
       field<&Board::realtime, &RealtimeSettings::lock_memory>("lock_memory",
                                                               "keep the whole program in memory (mlockall)")
           .otherwise(V{false}),
       field<&Board::realtime, &RealtimeSettings::acquire_cpus>(
           "acquire_cpus", "where the thread that reads the eye runs; []: anywhere")
           .within({0, 1023})
           .otherwise(V{std::vector<std::int64_t>()}),
       field<&Board::realtime, &RealtimeSettings::solve_cpus>("solve_cpus",
                                                              "where every other thread runs; []: anywhere")
           .within({0, 1023})
           .otherwise(V{std::vector<std::int64_t>()})});
  return all;
}

}  // namespace compueye::firmware
