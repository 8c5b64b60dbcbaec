#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace compueye::frontend {

/// What can go wrong between converters and their source.
enum class FrontEndFaultKind : std::uint8_t {
  edges_stuck,     ///< data-ready does not move for duration_ns; 0: until the chip is reset
  edges_missed,    ///< the next `count` edges never reach the kernel
  edges_unqueued,  ///< the kernel had no room for the next `count` edges: it has counted them
  edges_doubled,   ///< each of the next `count` edges rings: a second one comes `value` ns behind it
  edge_storm,      ///< data-ready oscillates, an edge every `value` ns, for duration_ns
  select_glitch,   ///< chip select goes up and down within the next `count` exchanges, in the middle of them
  clock_lost,      ///< a clock does not arrive in each of the next `count` exchanges, at bit `value`
  clock_doubled,   ///< a clock arrives twice, likewise
  bit_error,       ///< a bit of the answer is turned in each of the next `count` exchanges, at bit `value`
  miso_low,        ///< the answer's line is stuck for duration_ns; 0: for ever
  miso_high,       ///< likewise
  bus_error,       ///< the next `count` exchanges fail before a clock of them
  answer_lost,     ///< the next `count` exchanges are carried out, and then fail
  slow_bus,        ///< the next `count` exchanges take `value` ns more
  clock_drift,     ///< the chips' crystal is off by `value` parts in a million from now on
  other_chip,      ///< the chip is of another kind from now on: answers are those of chip `value` of front_ends()
  brown_out,       ///< chip `value` & 0xff starts anew in the next exchange, before byte `value` >> 8
  gone,            ///< the device files are gone; they come back after duration_ns with chips that start anew, 0: never
};
inline constexpr std::size_t front_end_fault_kind_count = static_cast<std::size_t>(FrontEndFaultKind::gone) + 1;

[[nodiscard]] std::string_view name(FrontEndFaultKind kind) noexcept;

/// A fault that begins at `at_ns`; one that is past, at once.
struct FrontEndFault {
  FrontEndFaultKind kind = FrontEndFaultKind::edges_stuck;
  std::int64_t at_ns = 0;
  std::int64_t duration_ns = 0;
  std::uint64_t count = 1;
  std::int64_t value = 0;
  int chip = -1;  ///< of faults in an exchange: of this one of the chips beside one another; -1: of whichever is next
};

}  // namespace compueye::frontend
