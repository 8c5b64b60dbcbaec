#include "drivers/protocol/packet_encoder.hpp"

#include <algorithm>
#include <cstring>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {
namespace {

/// Header and CRC around a payload that already lies in its place.
std::size_t close_packet(const FrameHeader& header, std::span<std::byte> into) noexcept {
  store(header, into.first<header_bytes>());
  const std::size_t covered = header_bytes + header.payload_bytes;
  store_little(into.data() + covered, crc32c(into.first(covered)));
  return header.packet_bytes();
}

}  // namespace

int channels_in(SampleFormat format, std::size_t payload_bytes) noexcept {
  const int bits = most_bits(format);
  return bits == 0 ? 0 : static_cast<int>(std::min(payload_bytes, most_payload_bytes) * 8) / bits;
}

std::size_t encode_packet(FrameHeader header, std::span<const std::byte> payload, std::span<std::byte> into) noexcept {
  if (payload.size() > most_payload_bytes || into.size() < least_packet_bytes + payload.size()) return 0;
  header.payload_bytes = static_cast<std::uint16_t>(payload.size());
  if (!payload.empty()) std::memmove(into.data() + header_bytes, payload.data(), payload.size());
  return close_packet(header, into);
}

std::size_t encode_data(FrameHeader header, std::span<const std::int32_t> codes, int bits,
                        std::span<std::byte> into) noexcept {
  const std::size_t bytes = packed_bytes(header.format, codes.size());
  if (codes.empty() || bytes == 0 || bytes > most_payload_bytes || into.size() < least_packet_bytes + bytes) return 0;
  header.type = PacketType::data;
  header.n_ch = static_cast<std::uint16_t>(codes.size());
  header.payload_bytes = static_cast<std::uint16_t>(bytes);
  if (!pack(header.format, codes, bits, into.subspan(header_bytes, bytes))) return 0;
  return close_packet(header, into);
}

void store(const EventPayload& event, std::span<std::byte, EventPayload::bytes> bytes) noexcept {
  store_little(bytes.data(), event.code);
  store_little(bytes.data() + 2, std::uint16_t{0});
  store_little(bytes.data() + 4, event.argument);
}

EventPayload load_event(std::span<const std::byte, EventPayload::bytes> bytes) noexcept {
  return {load_little<std::uint16_t>(bytes.data()), load_little<std::uint32_t>(bytes.data() + 4)};
}

}  // namespace compueye::protocol
