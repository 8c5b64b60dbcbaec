#pragma once

#include <cstdint>
#include <random>

#include "drivers/frontend/front_end_faults.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/hal/units.hpp"

namespace compueye::device::tests {

using frontend::FrontEndFault;
using frontend::FrontEndFaultKind;

constexpr std::int64_t longest_fault_ns = 150 * test::ms;

/// One of a kind, as a seed has it.
template <class Random>
FrontEndFault drawn(FrontEndFaultKind kind, std::int64_t period_ns, Random& random) {
  const auto pick = [&](std::int64_t from, std::int64_t to) {
    return std::uniform_int_distribution<std::int64_t>(from, to)(random);
  };
  FrontEndFault fault{.kind = kind, .at_ns = pick(0, 3 * period_ns), .count = static_cast<std::uint64_t>(pick(1, 5))};
  switch (kind) {
    case FrontEndFaultKind::edges_stuck:
    case FrontEndFaultKind::miso_low:
    case FrontEndFaultKind::miso_high:
      fault.duration_ns = pick(period_ns, longest_fault_ns);
      break;
    case FrontEndFaultKind::edges_doubled:
      fault.value = pick(100, period_ns / 3);
      break;
    case FrontEndFaultKind::edge_storm:
      fault.value = pick(2'000, period_ns / 4);
      fault.duration_ns = pick(period_ns, 30 * period_ns);
      break;
    case FrontEndFaultKind::slow_bus:
      fault.value = pick(1'000, 3 * period_ns);
      break;
    case FrontEndFaultKind::clock_drift:
      fault.value = pick(-2000, 2000);
      break;
    case FrontEndFaultKind::brown_out:
      fault.value = pick(0, 7) + (pick(0, 29) << 8);
      break;
    case FrontEndFaultKind::gone:
      fault.duration_ns = pick(test::ms, longest_fault_ns);
      break;
    default:
      fault.value = pick(0, 1000);
  }
  return fault;
}

/// Of the line that says when data are ready.
inline bool of_edges(FrontEndFaultKind kind) {
  return kind <= FrontEndFaultKind::edge_storm;
}

/// A kind that a source gets over.
template <class Random>
FrontEndFaultKind any_kind(Random& random, bool with_edges = true) {
  while (true) {
    const auto kind = static_cast<FrontEndFaultKind>(random() % frontend::front_end_fault_kind_count);
    if (kind != FrontEndFaultKind::other_chip && (with_edges || !of_edges(kind))) return kind;
  }
}

/// Whether whatever such a fault makes of a frame is told.
inline bool told_by(const ConverterEye& eye, FrontEndFaultKind kind) {
  switch (kind) {
    case FrontEndFaultKind::bit_error:
      return eye.tells_bits;
    case FrontEndFaultKind::clock_lost:
    case FrontEndFaultKind::clock_doubled:
    case FrontEndFaultKind::select_glitch:
    case FrontEndFaultKind::brown_out:
    case FrontEndFaultKind::miso_low:
    case FrontEndFaultKind::miso_high:
      return eye.tells_clocks;
    default:
      return true;
  }
}

}  // namespace compueye::device::tests
