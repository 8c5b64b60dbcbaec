// Whether the machine keeps time.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include "firmware/doctor/doctor_check.hpp"
#include "firmware/doctor/system_file.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t wanted_priority = 50;
constexpr std::uint64_t mib = 1U << 20U;
constexpr std::uint64_t wanted_locked = 256 * mib;

/// Folders whose name begins so, in their order.
std::vector<std::string> folders(const std::string& in, std::string_view begin) {
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator at(in, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename().string().starts_with(begin)) found.push_back(at->path().string());
  }
  std::ranges::sort(found);
  return found;
}

std::string user_limits(const char* what) {
  return fmt::format(
      "as root: echo '@compueye - {}' > /etc/security/limits.d/compueye.conf, join the group compueye, "
      "and log in again",
      what);
}

}  // namespace

Finding examine_kernel(const Examined& e) {
  const auto release = first_line(e.root + "/proc/sys/kernel/osrelease");
  const std::string which = release ? "Linux " + *release : "its version is not told";
  if (number_in(e.root + "/sys/kernel/realtime").value_or(0) == 1) return {Health::good, which + ", PREEMPT_RT"};
  return {Health::note, which + ", which keeps real time as a rule and promises nothing",
          "install a kernel with PREEMPT_RT (Debian: linux-image-rt-...) where a frame late by milliseconds matters"};
}

Finding examine_governor(const Examined& e) {
  std::vector<std::string> slow;
  int counted = 0;
  for (const std::string& cpu : folders(e.root + "/sys/devices/system/cpu", "cpu")) {
    const auto governor = first_line(cpu + "/cpufreq/scaling_governor");
    if (!governor) continue;
    ++counted;
    if (*governor != "performance") slow.push_back(*governor);
  }
  if (counted == 0) return {Health::none, "the clock of this processor is not the system's to change"};
  if (slow.empty()) return {Health::good, fmt::format("performance on {} processors", counted)};
  return {Health::note,
          fmt::format("{} of {} processors have '{}', which wakes up slowly", slow.size(), counted, slow.front()),
          "as root: echo performance | tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"};
}

Finding examine_throttling(const Examined& e) {
  constexpr long undervoltage_now = 1, throttled_now = 4, hot_now = 8, ever = 0xF0000;
  const auto flags = number_in(e.root + "/sys/devices/platform/soc/soc:firmware/get_throttled");
  if (flags && (*flags & (undervoltage_now | throttled_now | hot_now)) != 0) {
    const bool supply = (*flags & undervoltage_now) != 0;
    return {Health::bad, supply ? "the supply's voltage is too low" : "the processor is slowed down because it is hot",
            supply ? "use the supply and the cable that belong to the board" : "cool it: a heat sink, a fan, free air"};
  }
  constexpr long hot_mc = 80'000;
  long hottest = std::numeric_limits<long>::min();
  for (const std::string& zone : folders(e.root + "/sys/class/thermal", "thermal_zone")) {
    hottest = std::max(hottest, number_in(zone + "/temp").value_or(hottest));
  }
  if (hottest >= hot_mc) {
    return {Health::note, fmt::format("{} degrees, near where processors are slowed down", hottest / 1000),
            "cool it: a heat sink, a fan, free air"};
  }
  if (flags && (*flags & ever) != 0) {
    return {Health::note, "it was slowed down or short of voltage since it was switched on",
            "use the supply that belongs to the board, and cool it"};
  }
  if (hottest == std::numeric_limits<long>::min() && !flags)
    return {Health::none, "nothing here tells its temperature"};
  return {Health::good,
          hottest == std::numeric_limits<long>::min() ? "not slowed down" : fmt::format("{} degrees", hottest / 1000)};
}

Finding examine_realtime(const Examined& e) {
  if (e.limits.realtime_priority >= wanted_priority) {
    return {Health::good, fmt::format("up to {}", e.limits.realtime_priority)};
  }
  return {Health::note,
          fmt::format("up to {}, expected {}: frames wait for whatever else the machine does",
                      e.limits.realtime_priority, wanted_priority),
          user_limits("rtprio 50")};
}

Finding examine_locking(const Examined& e) {
  if (e.limits.locked_bytes == std::numeric_limits<std::uint64_t>::max()) return {Health::good, "as much as there is"};
  if (e.limits.locked_bytes >= wanted_locked) {
    return {Health::good, fmt::format("{} MiB", e.limits.locked_bytes / mib)};
  }
  return {Health::note,
          fmt::format("{} MiB, expected {}: a frame may wait for the disk", e.limits.locked_bytes / mib,
                      wanted_locked / mib),
          user_limits("memlock unlimited")};
}

Finding examine_clock_source(const Examined& e) {
  const auto source = first_line(e.root + "/sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (!source) return {Health::none, "the system does not tell it"};
  if (source->find("jiffies") != std::string::npos) {
    return {Health::bad, "'" + *source + "', which counts milliseconds: times of frames mean nothing",
            "remove clocksource= and notsc from the kernel's command line"};
  }
  if (*source == "hpet" || *source == "acpi_pm") {
    return {Health::note, "'" + *source + "', which takes microseconds to read",
            "look why the kernel left the processor's own: dmesg | grep -i clocksource"};
  }
  return {Health::good, *source};
}

Finding examine_space(const Examined& e) {
  constexpr std::uint64_t least = 64 * mib, wanted = 1024 * mib;
  std::string where = e.board.cache();
  std::error_code error;
  while (!where.empty() && !fs::exists(where, error)) where = fs::path(where).parent_path().string();
  if (where.empty()) where = ".";
  const fs::space_info space = fs::space(where, error);
  if (error) return {Health::none, where + ": " + error.message()};
  const std::string free = fmt::format("{} MiB at {}", space.available / mib, where);
  if (space.available < least) return {Health::bad, free, "make room: the runtime keeps factors and points there"};
  if (space.available < wanted)
    return {Health::note, free, "make room before recording: --record says how much it takes"};
  return {Health::good, free};
}

}  // namespace compueye::firmware
