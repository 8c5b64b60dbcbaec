#include "drivers/protocol/frame_header.hpp"

#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {

void store(const FrameHeader& header, std::span<std::byte, header_bytes> bytes) noexcept {
  std::byte* const at = bytes.data();
  store_little(at, packet_magic);
  store_little(at + 4, header.version.byte());
  store_little(at + 5, static_cast<std::uint8_t>(header.type));
  store_little(at + 6, header.flags);
  store_little(at + 8, header.seq);
  store_little(at + 12, header.frame);
  store_little(at + 16, header.t_ns);
  store_little(at + 24, header.config_id);
  store_little(at + 28, header.first_ch);
  store_little(at + 30, header.n_ch);
  store_little(at + 32, static_cast<std::uint8_t>(header.format));
  store_little(at + 33, header.illum);
  store_little(at + 34, header.temperature);
  store_little(at + 36, header.payload_bytes);
  store_little(at + 38, header.dropped);
}

FrameHeader load_header(std::span<const std::byte, header_bytes> bytes) noexcept {
  const std::byte* const at = bytes.data();
  FrameHeader header;
  header.version = ProtocolVersion::from_byte(load_little<std::uint8_t>(at + 4));
  header.type = static_cast<PacketType>(load_little<std::uint8_t>(at + 5));
  header.flags = load_little<std::uint16_t>(at + 6);
  header.seq = load_little<std::uint32_t>(at + 8);
  header.frame = load_little<std::uint32_t>(at + 12);
  header.t_ns = load_little<std::uint64_t>(at + 16);
  header.config_id = load_little<std::uint32_t>(at + 24);
  header.first_ch = load_little<std::uint16_t>(at + 28);
  header.n_ch = load_little<std::uint16_t>(at + 30);
  header.format = static_cast<SampleFormat>(load_little<std::uint8_t>(at + 32));
  header.illum = load_little<std::uint8_t>(at + 33);
  header.temperature = load_little<std::int16_t>(at + 34);
  header.payload_bytes = load_little<std::uint16_t>(at + 36);
  header.dropped = load_little<std::uint16_t>(at + 38);
  return header;
}

bool plausible(const FrameHeader& header, const PacketLimits& limits) noexcept {
  if (header.version.major_number != host_version.major_number) return false;
  if (header.payload_bytes > limits.payload_bytes) return false;
  if (header.type != PacketType::data) return true;
  return known(header.format) && header.n_ch >= 1 && header.first_ch + header.n_ch <= limits.channels &&
         packed_bytes(header.format, header.n_ch) == header.payload_bytes;
}

}  // namespace compueye::protocol
