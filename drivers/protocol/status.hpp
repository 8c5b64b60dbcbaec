#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/protocol/version.hpp"
#include "hal/result.hpp"

namespace compueye::protocol {

enum class DeviceState : std::uint8_t { idle = 0, configured = 1, streaming = 2 };

/// Why the device refused the last request that it refused.
enum class StatusError : std::uint8_t {
  none = 0,
  unknown_request = 1,
  wrong_length = 2,
  wrong_state = 3,
  out_of_limits = 4
};

/// STATUS's reply, 48 bytes.
struct Status {
  static constexpr std::size_t bytes = 48;

  DeviceState state = DeviceState::idle;
  ProtocolVersion version = host_version;
  std::uint8_t illum = 0;  ///< as FrameHeader::illum
  StatusError last_error = StatusError::none;
  std::uint32_t config_id = 0;         ///< 0: not configured
  std::uint32_t boot_count = 0;        ///< another one after every start of the firmware
  std::int16_t temperature = 0;        ///< 0.01 degrees C
  std::uint16_t fifo_permille = 0;     ///< how full the device's memory is
  std::uint32_t frames = 0;            ///< exposures since START, modulo 2^32
  std::uint32_t overruns = 0;          ///< frames dropped for want of memory since START
  std::uint32_t packets = 0;           ///< put into the stream since START, modulo 2^32
  std::uint32_t refused_requests = 0;  ///< since the firmware started
  std::uint64_t now_ns = 0;            ///< the device clock
  std::uint64_t last_t_ns = 0;         ///< start of exposure of frame `frames` - 1; 0 when there is none
  friend bool operator==(const Status&, const Status&) noexcept = default;
};

void store(const Status& status, std::span<std::byte, Status::bytes> bytes) noexcept;
/// Error bad_format: too short, or an unknown state. A longer reply comes from a newer minor version.
[[nodiscard]] hal::Result<Status> parse_status(std::span<const std::byte> bytes, std::string_view place);

/// PING's reply, 8 bytes, the same in every version of the protocol.
struct PingReply {
  static constexpr std::size_t bytes = 8;
  std::uint32_t nonce = 0;  ///< that of the request
  ProtocolVersion version = host_version;
  DeviceState state = DeviceState::idle;
};
void store(const PingReply& reply, std::span<std::byte, PingReply::bytes> bytes) noexcept;
/// Errors: bad_format (too short), mismatch (the nonce of another request).
[[nodiscard]] hal::Result<PingReply> parse_ping(std::span<const std::byte> bytes, std::uint32_t nonce,
                                                std::string_view place);

}  // namespace compueye::protocol
