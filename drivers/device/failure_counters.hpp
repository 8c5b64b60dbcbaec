#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace compueye::device {

/// Everything that can go wrong between an eye and its source, and what was done about it. One counter each.
enum class Failure : std::uint8_t {
  // The connection
  unplugged,     ///< the device went away while it was open
  absent,        ///< it was looked for and not there
  open_failed,   ///< it was there and could not be opened
  other_serial,  ///< another eye was in its place
  rebooted,      ///< its firmware has started anew (another boot_count)
  // Requests
  request_timeout,   ///< not answered within protocol::control_deadline_ns
  request_refused,   ///< stalled, or the transport failed
  bad_reply,         ///< answered with what is not a reply
  other_version,     ///< it speaks another major version of the protocol
  other_descriptor,  ///< the same serial with other channels, depth or formats
  wrong_echo,        ///< GET_CONFIG returned another configuration than was set
  // The stream
  silence,        ///< no frame for DeviceSettings::silence_ns, and no bytes either
  stream_failed,  ///< the stream's endpoint halted, or the transport failed
  babble,         ///< bytes without end and no frame in them
  // Its bytes
  crc_error,         ///< packets or reports whose CRC is wrong
  garbage,           ///< magic numbers before nonsense, reports of no known kind
  resync,            ///< good packets found again after bytes that were none (USB)
  cut_report,        ///< reports of another length
  missing_packet,    ///< by the sequence numbers (USB)
  repeated_part,     ///< samples that had come already
  late_part,         ///< of a frame whose fate was settled
  other_config,      ///< left over from another configuration, or of a device that has started anew
  incomplete_frame,  ///< delivered with channels missing
  bad_code,          ///< codes beyond the depth, made invalid
  doubtful_time,     ///< frames whose time is not to be trusted
  // What was done
  restart,    ///< the stream was reset
  bus_reset,  ///< the device was closed and opened again
  gave_up,    ///< recovery was given up
};
inline constexpr std::size_t failure_count = 28;

[[nodiscard]] std::string_view name(Failure failure) noexcept;

struct FailureCounters {
  std::array<std::uint64_t, failure_count> counts{};

  std::uint64_t& operator[](Failure failure) noexcept { return counts[static_cast<std::size_t>(failure)]; }
  std::uint64_t operator[](Failure failure) const noexcept { return counts[static_cast<std::size_t>(failure)]; }
  /// "silence 2, restart 2": those that are not 0; "none" when all are.
  [[nodiscard]] std::string text() const;
};

}  // namespace compueye::device
