#include "tests/hil/soak/random_faults.hpp"
#include "tests/hal/units.hpp"

#include <algorithm>

namespace compueye::hil {
namespace {

using protocol::EmulatorFault;
using protocol::FaultKind;

using compueye::test::ms;

}  // namespace

Incident RandomFaults::next(std::int64_t now_ns) {
  Incident incident;
  const std::uint64_t of_way = below(4);
  for (std::uint64_t k = 0; k < of_way; ++k) incident.faults.push_back(of_the_way(now_ns));
  if (of_way == 0 || below(2) == 0) {
    // Behind the others: a clock that is set right after a reboot hides when that was.
    add_of_the_device(incident.faults, now_ns + 30 * ms + up_to_ns(40 * ms));
  } else if (below(3) == 0) {
    incident.reader_sleeps_ns = up_to_ns(1500 * ms);
  }
  incident.over_ns = now_ns + incident.reader_sleeps_ns + 1000 * ms;
  return incident;
}

Incident RandomFaults::meeting(std::int64_t now_ns) {
  Incident incident;
  for (std::uint64_t k = below(5); k > 0; --k) {
    incident.faults.push_back(of_the_way(now_ns));
    incident.faults.back().at_ns += up_to_ns(300 * ms);
  }
  if (below(2) == 0) {
    incident.faults.push_back(
        {.kind = FaultKind::lose_answers, .at_ns = now_ns + up_to_ns(200 * ms), .count = 1 + below(6)});
  }
  bool away = false, echo = false;
  for (std::uint64_t k = 1 + below(3); k > 0; --k) {
    std::vector<EmulatorFault> more;
    add_of_the_device(more, now_ns + up_to_ns(300 * ms));
    const auto any = [&](FaultKind kind) {
      return std::any_of(more.begin(), more.end(), [&](const EmulatorFault& each) { return each.kind == kind; });
    };
    // One eye at a time goes, or it is another that comes back; three wrong echoes in a row end it.
    const bool goes = any(FaultKind::unplug) || any(FaultKind::replug_other), wrong = any(FaultKind::wrong_echo);
    if ((goes && away) || (wrong && echo)) continue;
    away = away || goes;
    echo = echo || wrong;
    incident.faults.insert(incident.faults.end(), more.begin(), more.end());
  }
  if (below(4) == 0) incident.reader_sleeps_ns = up_to_ns(below(8) == 0 ? 800'000 * ms : 1500 * ms);
  incident.over_ns = now_ns + incident.reader_sleeps_ns + 1500 * ms;
  return incident;
}

EmulatorFault RandomFaults::of_the_way(std::int64_t now_ns) {
  EmulatorFault fault;
  fault.at_ns = now_ns + up_to_ns(30 * ms);
  fault.count = 1 + below(40);
  constexpr FaultKind kinds[] = {FaultKind::short_read,        FaultKind::bit_error,    FaultKind::lose_packets,
                                 FaultKind::duplicate_packets, FaultKind::overrun,      FaultKind::clock_jump,
                                 FaultKind::control_silence,   FaultKind::stall_control};
  fault.kind = kinds[below(std::size(kinds))];
  switch (fault.kind) {
    case FaultKind::clock_jump:
      fault.value = up_to_ns(20'000 * ms) - 10'000 * ms;
      break;
    case FaultKind::control_silence:
      fault.duration_ns = up_to_ns(400 * ms);
      break;
    case FaultKind::stall_control:
      fault.count = 1 + below(5);
      break;
    default:
      break;
  }
  return fault;
}

void RandomFaults::add_of_the_device(std::vector<EmulatorFault>& faults, std::int64_t at_ns) {
  EmulatorFault fault;
  fault.at_ns = at_ns;
  switch (below(7)) {
    case 0:
      fault.kind = FaultKind::silence;
      fault.duration_ns = below(4) == 0 ? 0 : up_to_ns(500 * ms);
      break;
    case 1:
      // Echoes are read only when it is configured again, and three wrong ones in a row end it.
      faults.push_back({.kind = FaultKind::wrong_echo, .at_ns = at_ns, .count = below(3)});
      fault.kind = FaultKind::stall_stream;
      break;
    case 2:
      fault.kind = FaultKind::unplug;
      fault.duration_ns = up_to_ns(3000 * ms);
      break;
    case 3:
      faults.push_back(
          {.kind = FaultKind::replug_other, .at_ns = at_ns, .duration_ns = up_to_ns(300 * ms), .text = "CE-OTHER"});
      fault.kind = FaultKind::replug_other;
      fault.at_ns = at_ns + 400 * ms;
      fault.duration_ns = up_to_ns(500 * ms);
      fault.text = serial_;
      break;
    case 4:
    case 5:
      if (below(4) == 0) faults.push_back({.kind = FaultKind::other_version, .at_ns = at_ns, .value = 0x12});
      fault.kind = FaultKind::reboot;
      fault.value = static_cast<std::int64_t>(below(2));
      break;
    default:
      fault.kind = FaultKind::babble;
      fault.duration_ns = below(4) == 0 ? 0 : up_to_ns(150 * ms);
      break;
  }
  faults.push_back(fault);
}

}  // namespace compueye::hil
