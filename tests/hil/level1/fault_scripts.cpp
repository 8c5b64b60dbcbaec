#include "tests/hil/level1/fault_scripts.hpp"
#include "tests/hal/units.hpp"

namespace compueye::hil {
namespace {

using protocol::EmulatorFault;
using protocol::FaultKind;
using Faults = std::vector<EmulatorFault>;

using compueye::test::ms;
using compueye::test::second;

/// Some parts of frames, of the last of them not all.
Faults damaged(FaultKind kind, const FaultMoment& m) {
  return {{.kind = kind, .at_frame = m.at_frame, .count = 1 + m.parts * (m.seed % 3)}};
}

/// A fault of requests shows when there are some: the stream halts as well.
Faults with_halted_stream(const FaultMoment& m, EmulatorFault fault) {
  fault.at_ns = m.at_ns;
  return {fault, {.kind = FaultKind::stall_stream, .at_ns = m.at_ns}};
}

const std::vector<FaultScript> scripts{
    {"pause",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::silence, .at_ns = m.at_ns, .duration_ns = 25 * ms}};
     },
     25 * ms},
    {"silence",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::silence, .at_ns = m.at_ns, .duration_ns = 300 * ms}};
     },
     300 * ms},
    {"silence until reset",
     [](const FaultMoment& m) { return Faults{{.kind = FaultKind::silence, .at_ns = m.at_ns}}; }},
    {"mute",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::silence, .at_ns = m.at_ns, .duration_ns = 1000 * second}};
     }},
    {"requests not answered",
     [](const FaultMoment& m) {
       return with_halted_stream(m, {.kind = FaultKind::control_silence, .duration_ns = 300 * ms});
     },
     300 * ms},
    {"requests not answered until bus reset",
     [](const FaultMoment& m) { return with_halted_stream(m, {.kind = FaultKind::control_silence}); }},
    {"answers lost",
     [](const FaultMoment& m) {
       return with_halted_stream(m, {.kind = FaultKind::lose_answers, .count = 1 + m.seed % 4});
     }},
    {"requests not answered, frames come",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::control_silence, .at_ns = m.at_ns, .duration_ns = 300 * ms}};
     },
     300 * ms},
    {"stream stalls", [](const FaultMoment& m) { return Faults{{.kind = FaultKind::stall_stream, .at_ns = m.at_ns}}; }},
    {"requests refused",
     [](const FaultMoment& m) {
       return with_halted_stream(m, {.kind = FaultKind::stall_control, .count = 1 + m.seed % 4});
     }},
    {"requests refused until bus reset",
     [](const FaultMoment& m) { return with_halted_stream(m, {.kind = FaultKind::stall_control, .count = 0}); }},
    {"short read", [](const FaultMoment& m) { return damaged(FaultKind::short_read, m); }},
    {"bit error", [](const FaultMoment& m) { return damaged(FaultKind::bit_error, m); }},
    {"packets lost", [](const FaultMoment& m) { return damaged(FaultKind::lose_packets, m); }},
    {"packets twice", [](const FaultMoment& m) { return damaged(FaultKind::duplicate_packets, m); }},
    {"wrong echo",
     [](const FaultMoment& m) {
       return with_halted_stream(m, {.kind = FaultKind::wrong_echo, .count = 1 + m.seed % 2});
     }},
    {"wrong echo for ever",
     [](const FaultMoment& m) { return with_halted_stream(m, {.kind = FaultKind::wrong_echo, .count = 1'000'000}); }},
    {"re-plug",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::unplug, .at_ns = m.at_ns, .duration_ns = 1200 * ms}};
     },
     1200 * ms},
    {"loose plug",
     [](const FaultMoment& m) {
       Faults faults;
       for (std::int64_t k = 0; k < 4; ++k) {
         faults.push_back({.kind = FaultKind::unplug, .at_ns = m.at_ns + k * 200 * ms, .duration_ns = 30 * ms});
       }
       return faults;
     },
     630 * ms},
    {"unplug", [](const FaultMoment& m) { return Faults{{.kind = FaultKind::unplug, .at_ns = m.at_ns}}; }},
    {"re-plug of another",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::replug_other, .at_ns = m.at_ns, .duration_ns = 100 * ms, .text = "CE-OTHER"}};
     }},
    {"re-plug of another, then of ours",
     [](const FaultMoment& m) {
       return Faults{
           {.kind = FaultKind::replug_other, .at_ns = m.at_ns, .duration_ns = 100 * ms, .text = "CE-OTHER"},
           {.kind = FaultKind::replug_other, .at_ns = m.at_ns + second, .duration_ns = 300 * ms, .text = m.serial}};
     },
     1300 * ms},
    {"clock forwards",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::clock_jump, .at_ns = m.at_ns, .value = 7 * second}};
     }},
    {"clock backwards",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::clock_jump, .at_ns = m.at_ns, .value = -7 * second}};
     }},
    {"reboot", [](const FaultMoment& m) { return Faults{{.kind = FaultKind::reboot, .at_ns = m.at_ns}}; }},
    {"reboot, streams unasked",
     [](const FaultMoment& m) { return Faults{{.kind = FaultKind::reboot, .at_ns = m.at_ns, .value = 1}}; }},
    {"reboots",
     [](const FaultMoment& m) {
       Faults faults;
       for (std::int64_t k = 0; k < 5; ++k) {
         faults.push_back({.kind = FaultKind::reboot, .at_ns = m.at_ns + k * 170 * ms, .value = k % 2});
       }
       return faults;
     },
     680 * ms},
    {"babble",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::babble, .at_ns = m.at_ns, .duration_ns = 200 * ms}};
     },
     200 * ms},
    {"babble until bus reset",
     [](const FaultMoment& m) { return Faults{{.kind = FaultKind::babble, .at_ns = m.at_ns}}; }},
    {"another protocol version",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::other_version, .at_frame = m.at_frame, .value = 0x20},
                     {.kind = FaultKind::reboot, .at_frame = m.at_frame}};
     }},
    {"newer minor version",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::other_version, .at_ns = m.at_ns, .value = 0x13},
                     {.kind = FaultKind::reboot, .at_ns = m.at_ns}};
     }},
    {"overrun",
     [](const FaultMoment& m) {
       return Faults{{.kind = FaultKind::overrun, .at_frame = m.at_frame, .count = 1 + m.seed % 3}};
     }},
};

}  // namespace

std::span<const FaultScript> fault_scripts() {
  return scripts;
}

}  // namespace compueye::hil
