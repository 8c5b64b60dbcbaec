#pragma once

#include <array>
#include <cstdint>

#include "drivers/device/counter_set.hpp"
#include "hal/counter.hpp"

namespace compueye::device {

/// Everything that can go wrong between an eye and its source, and what was done about it: a row a counter, of its name
/// and its meaning. docs/faults.md says which ones move when.
#define COMPUEYE_FAILURES(ROW)                                                                    \
  /* The connection */                                                                            \
  ROW(unplugged, "the device went away while it was open")                                        \
  ROW(absent, "it was looked for and not there")                                                  \
  ROW(open_failed, "it was there and could not be opened")                                        \
  ROW(other_serial, "another eye was in its place")                                               \
  ROW(rebooted, "its firmware has started anew (another boot_count)")                             \
  /* Requests */                                                                                  \
  ROW(request_timeout, "a request was not answered in the time that a device may take")           \
  ROW(request_refused, "a request was stalled, or the transport failed")                          \
  ROW(bad_reply, "a request was answered with what is not a reply")                               \
  ROW(other_version, "it speaks another major version of the protocol")                           \
  ROW(other_descriptor, "the same serial with other channels, depth or formats")                  \
  ROW(wrong_echo, "GET_CONFIG returned another configuration than was set")                       \
  /* The stream */                                                                                \
  ROW(silence, "no frame for too long, and no bytes either")                                      \
  ROW(stream_failed, "the stream's endpoint halted, or the transport failed")                     \
  ROW(babble, "bytes without end and no frame in them")                                           \
  ROW(late_reader, "nobody read for longer than frame numbers can tell")                          \
  /* Its bytes */                                                                                 \
  ROW(crc_error, "packets or reports whose CRC is wrong")                                         \
  ROW(garbage, "magic numbers before nonsense, reports of no known kind")                         \
  ROW(resync, "good packets found again after bytes that were none (USB)")                        \
  ROW(cut_report, "reports of another length (HID)")                                              \
  ROW(missing_packet, "packets that never came, by the sequence numbers (USB)")                   \
  ROW(repeated_part, "samples that had come already")                                             \
  ROW(late_part, "samples of a frame whose fate was settled")                                     \
  ROW(other_config, "left over from another configuration, or of a device that has started anew") \
  ROW(incomplete_frame, "frames delivered with channels missing")                                 \
  ROW(bad_code, "codes beyond the depth, made invalid")                                           \
  ROW(wrong_number, "samples of a frame that the time since START had no room for")               \
  ROW(doubtful_time, "frames whose time is not to be trusted")                                    \
  /* What was done: from here on no faults */                                                     \
  ROW(restart, "the stream was reset")                                                            \
  ROW(bus_reset, "the device was closed and opened again")                                        \
  ROW(gave_up, "recovery was given up")

enum class Failure : std::uint8_t {
#define COMPUEYE_FAILURE(name, meaning) name,
  COMPUEYE_FAILURES(COMPUEYE_FAILURE)
#undef COMPUEYE_FAILURE
};

/// In the order of Failure; their counts are 0.
inline constexpr std::array failure_rows{
#define COMPUEYE_FAILURE(name, meaning) hal::Counter{#name, meaning, 0, Failure::name < Failure::restart},
    COMPUEYE_FAILURES(COMPUEYE_FAILURE)
#undef COMPUEYE_FAILURE
};
#undef COMPUEYE_FAILURES

/// How often each has happened.
using FailureCounters = CounterSet<Failure, failure_rows>;

}  // namespace compueye::device
