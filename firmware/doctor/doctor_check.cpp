#include "firmware/doctor/doctor_check.hpp"

#include <sys/resource.h>

#include <array>
#include <limits>

namespace compueye::firmware {
namespace {

std::uint64_t limit_of(decltype(RLIMIT_MEMLOCK) which) noexcept {
  rlimit limit{};
  if (::getrlimit(which, &limit) != 0) return 0;
  return limit.rlim_cur == RLIM_INFINITY ? std::numeric_limits<std::uint64_t>::max() : limit.rlim_cur;
}

constexpr std::array checks{
    DoctorCheck{"device files", "may this user open what the eye hangs on", examine_device_files},
    DoctorCheck{"udev rule", "does a rule let users open an eye on USB", examine_udev_rule},
    DoctorCheck{"spidev bufsiz", "does a frame go through spidev in few calls", examine_bufsiz},
    DoctorCheck{"usbfs memory", "may transfers in flight have their memory", examine_usbfs},
    DoctorCheck{"eye", "is the board's eye there, and does it test itself as good", examine_eye},
    DoctorCheck{"link", "do frames come whole and in time", examine_link},
    DoctorCheck{"deadline", "what does this machine's own measurement say of it", examine_deadline},
    DoctorCheck{"kernel", "does it keep real time", examine_kernel},
    DoctorCheck{"governor", "does the processor keep its clock", examine_governor},
    DoctorCheck{"throttling", "is it cool, and its supply good", examine_throttling},
    DoctorCheck{"real-time priority", "may the runtime ask for one", examine_realtime},
    DoctorCheck{"locked memory", "may the runtime keep its memory out of the swap", examine_locking},
    DoctorCheck{"clock source", "can time be read quickly", examine_clock_source},
    DoctorCheck{"free space", "is there room for the cache and for a recording", examine_space},
};

}  // namespace

std::string_view name(Health health) noexcept {
  static constexpr std::array<std::string_view, 4> names{"good", "note", "bad", "-"};
  return names[static_cast<std::size_t>(health)];
}

Limits own_limits() noexcept {
  return {limit_of(RLIMIT_RTPRIO), limit_of(RLIMIT_MEMLOCK)};
}

std::span<const DoctorCheck> doctor_checks() noexcept {
  return checks;
}

std::string doctor_reference() {
  std::string text = "| check | what it asks |\n|---|---|\n";
  for (const DoctorCheck& each : checks) {
    text += "| " + std::string(each.name) + " | " + std::string(each.question) + "? |\n";
  }
  return text;
}

}  // namespace compueye::firmware
