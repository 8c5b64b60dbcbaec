#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/protocol/sample_format.hpp"
#include "drivers/protocol/version.hpp"

namespace compueye::protocol {

/// What a packet carries. A type that is none of these comes from a newer minor version and is passed over.
enum class PacketType : std::uint8_t {
  data = 1,   ///< samples of one frame, all or some channels
  event = 2,  ///< an EventPayload: something happened in the device
  log = 3,    ///< UTF-8 text for people
};

/// Bits of FrameHeader::flags; the others are 0 when sent and ignored when received.
namespace packet_flag {
inline constexpr std::uint16_t sof = 1U << 0U;      ///< first data packet of its frame
inline constexpr std::uint16_t eof = 1U << 1U;      ///< last data packet of its frame
inline constexpr std::uint16_t overrun = 1U << 2U;  ///< frames were dropped in the device just before this one
inline constexpr std::uint16_t sat = 1U << 3U;      ///< a channel of this packet is at full scale
inline constexpr std::uint16_t dark = 1U << 4U;     ///< exposed with every illuminator off and settled
inline constexpr std::uint16_t time_ok = 1U << 5U;  ///< the device clock runs and has not been set since the last frame
}  // namespace packet_flag

/// FrameHeader::illum while the light is changing.
inline constexpr std::uint8_t illumination_changing = 0xFF;

inline constexpr std::size_t header_bytes = 40;
inline constexpr std::size_t packet_crc_bytes = 4;
inline constexpr std::size_t most_payload_bytes = 65535;
inline constexpr std::size_t least_packet_bytes = header_bytes + packet_crc_bytes;
inline constexpr int most_channels = 65535;
inline constexpr std::uint32_t packet_magic = 0x45594543U;  ///< the bytes "CEYE"

/// The 40 bytes in front of every packet's payload (docs/protocol.md, "Packet"). A CRC-32C over header and payload
/// follows the payload.
struct FrameHeader {
  ProtocolVersion version = host_version;
  PacketType type = PacketType::data;
  std::uint16_t flags = 0;      ///< packet_flag
  std::uint32_t seq = 0;        ///< counts every packet put into the stream since START, from 0, modulo 2^32
  std::uint32_t frame = 0;      ///< counts every exposure since START, from 0, modulo 2^32
  std::uint64_t t_ns = 0;       ///< start of exposure (data) or when it happened, on the device clock
  std::uint32_t config_id = 0;  ///< that of the configuration in force; 0: none
  std::uint16_t first_ch = 0;   ///< data: first channel in the payload; else 0
  std::uint16_t n_ch = 0;       ///< data: number of channels, >= 1; else 0
  SampleFormat format = SampleFormat::u16;
  std::uint8_t illum = 0;        ///< tag of the illumination in force, or illumination_changing
  std::int16_t temperature = 0;  ///< 0.01 degrees C
  std::uint16_t payload_bytes = 0;
  std::uint16_t dropped = 0;  ///< frames that the device dropped for want of memory since START, modulo 2^16

  [[nodiscard]] bool has(std::uint16_t flag) const noexcept { return (flags & flag) != 0; }
  /// Of the whole packet: header, payload, CRC.
  [[nodiscard]] std::size_t packet_bytes() const noexcept { return least_packet_bytes + payload_bytes; }
  friend bool operator==(const FrameHeader&, const FrameHeader&) noexcept = default;
};

/// What a receiver knows beforehand and holds every header against.
struct PacketLimits {
  int channels = most_channels;                    ///< M of the descriptor: 1 .. 65535
  std::size_t payload_bytes = most_payload_bytes;  ///< the longest payload the device may send: 1 .. 65535
};

/// A header of another magic number is not touched by these: a receiver looks for the magic first.
void store(const FrameHeader& header, std::span<std::byte, header_bytes> bytes) noexcept;
[[nodiscard]] FrameHeader load_header(std::span<const std::byte, header_bytes> bytes) noexcept;

/// Whether a header can belong to a packet: the major version is ours, the payload within its limit and, for data, the
/// format known, the channels among M and the payload exactly as long as they need.
[[nodiscard]] bool plausible(const FrameHeader& header, const PacketLimits& limits) noexcept;

}  // namespace compueye::protocol
