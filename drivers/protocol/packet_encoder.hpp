#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/protocol/frame_header.hpp"

namespace compueye::protocol {

/// Channels that fit a payload of at most `payload_bytes`, at most 65535.
[[nodiscard]] int channels_in(SampleFormat format, std::size_t payload_bytes) noexcept;

/// Writes one whole packet: header (its payload_bytes set to the payload's size), payload, CRC. Returns its length; 0,
/// with nothing written, when the payload is longer than 65535 bytes or `into` too small.
std::size_t encode_packet(FrameHeader header, std::span<const std::byte> payload, std::span<std::byte> into) noexcept;

/// Writes a data packet of codes 0 .. 2^bits - 1 for the channels from header.first_ch on; n_ch and payload_bytes are
/// set here. Returns its length; 0, with nothing written, when it does not fit its limits or `into`.
std::size_t encode_data(FrameHeader header, std::span<const std::int32_t> codes, int bits,
                        std::span<std::byte> into) noexcept;

/// Payload of an event packet, 8 bytes.
struct EventPayload {
  static constexpr std::size_t bytes = 8;
  static constexpr std::uint16_t illumination_settled = 1;  ///< argument: the tag
  static constexpr std::uint16_t overrun_began = 2;         ///< argument: frames dropped so far
  static constexpr std::uint16_t clock_set = 3;             ///< argument: 0
  static constexpr std::uint16_t temperature_limit = 4;     ///< argument: 0.01 degrees C, two's complement

  std::uint16_t code = 0;
  std::uint32_t argument = 0;
};
void store(const EventPayload& event, std::span<std::byte, EventPayload::bytes> bytes) noexcept;
[[nodiscard]] EventPayload load_event(std::span<const std::byte, EventPayload::bytes> bytes) noexcept;

}  // namespace compueye::protocol
