#pragma once

#include <array>
#include <cstdint>

#include "drivers/device/counter_set.hpp"
#include "hal/counter.hpp"

namespace compueye::device {

/// Everything that can go wrong between converters and their source, and what was done about it, as
/// COMPUEYE_FAILURES are for eyes of the protocol. docs/faults.md says which ones move when.
#define COMPUEYE_CONVERTER_FAILURES(ROW)                                             \
  /* The wires */                                                                    \
  ROW(absent, "device files were looked for and not there")                          \
  ROW(gone, "they went away while they were open")                                   \
  ROW(open_failed, "they were there and could not be opened")                        \
  ROW(bus_error, "a transfer failed")                                                \
  ROW(line_error, "a line could not be read or set")                                 \
  ROW(wrong_chip, "a chip did not answer as its kind does")                          \
  /* Data-ready */                                                                   \
  ROW(silence, "no frame for too long")                                              \
  ROW(missed_edge, "frames that no edge told of")                                    \
  ROW(spurious_edge, "edges of no frame")                                            \
  ROW(unclear_edge, "frames among so many edges that none can be told to be theirs") \
  ROW(late_host, "frames that were over before the host came to them")               \
  ROW(torn_frame, "frames that the next conversion may have overtaken")              \
  /* What chips tell: a row a ChipFault */                                           \
  ROW(crc_error, "chips whose checksum was wrong in a frame")                        \
  ROW(wrong_place, "chips whose bits were not where they belong")                    \
  ROW(stuck_low, "chips that answered nothing but zeros")                            \
  ROW(stuck_high, "chips that answered nothing but ones")                            \
  ROW(lost_settings, "chips that had started anew")                                  \
  ROW(no_new_sample, "chips that had converted nothing since")                       \
  ROW(incomplete_frame, "frames delivered with channels missing")                    \
  /* What was done: from here on no faults */                                        \
  ROW(restart, "the chips were reset and set anew")                                  \
  ROW(reopen, "the device files were closed and opened again")                       \
  ROW(gave_up, "recovery was given up")

enum class ConverterFailure : std::uint8_t {
#define COMPUEYE_FAILURE(name, meaning) name,
  COMPUEYE_CONVERTER_FAILURES(COMPUEYE_FAILURE)
#undef COMPUEYE_FAILURE
};

/// In the order of ConverterFailure; their counts are 0.
inline constexpr std::array converter_failure_rows{
#define COMPUEYE_FAILURE(name, meaning) \
  hal::Counter{#name, meaning, 0, ConverterFailure::name < ConverterFailure::restart},
    COMPUEYE_CONVERTER_FAILURES(COMPUEYE_FAILURE)
#undef COMPUEYE_FAILURE
};
#undef COMPUEYE_CONVERTER_FAILURES

using ConverterFailures = CounterSet<ConverterFailure, converter_failure_rows>;

}  // namespace compueye::device
