#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/packet_encoder.hpp"
#include "drivers/protocol/sample_format.hpp"

/// Bytes of the wire and what they mean, drawn at random.
namespace compueye::protocol::tests {

using Random = std::mt19937_64;

inline std::size_t below(Random& random, std::size_t limit) {
  return static_cast<std::size_t>(random() % limit);
}

inline std::vector<std::byte> random_bytes(Random& random, std::size_t count) {
  std::vector<std::byte> bytes(count);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

inline std::vector<std::int32_t> random_codes(Random& random, std::size_t count, int bits) {
  std::vector<std::int32_t> codes(count);
  for (std::int32_t& code : codes) code = static_cast<std::int32_t>(random() & ((1U << bits) - 1U));
  return codes;
}

inline constexpr std::array all_formats{SampleFormat::u16, SampleFormat::u12, SampleFormat::i24};

/// A right descriptor with everything in it: a shuffled channel map, sample offsets, two illuminators.
inline DeviceDescriptor descriptor_of(int channels, int bits, std::uint64_t seed = 1) {
  Random random(seed);
  DeviceDescriptor d;
  d.serial = "CE-" + std::to_string(seed);
  d.firmware = "1.2.3";
  d.channels = channels;
  d.bits = bits;
  for (const SampleFormat format : all_formats) {
    if (most_bits(format) >= bits) d.formats.push_back(format);
  }
  d.least_frame_rate_mhz = 1000;
  d.most_frame_rate_mhz = 10'000'000;
  d.least_exposure_ns = 1000;
  d.most_exposure_ns = 1'000'000'000;
  d.ommatidium_of_channel.resize(static_cast<std::size_t>(channels));
  std::iota(d.ommatidium_of_channel.begin(), d.ommatidium_of_channel.end(), 0);
  std::shuffle(d.ommatidium_of_channel.begin(), d.ommatidium_of_channel.end(), random);
  for (int c = 0; c < channels; ++c) d.sample_offset_ns.push_back(c * 100);
  d.illuminators = {{1, IlluminatorKind::lamp, 2, 1, 1, 2'000'000},
                    {7, IlluminatorKind::display, 256, 16, 16, 30'000'000}};
  return d;
}

struct SentPacket {
  FrameHeader header;
  std::vector<std::byte> payload;
  std::size_t at = 0;  ///< in the stream

  [[nodiscard]] std::size_t end() const { return at + header.packet_bytes(); }
};

struct SentStream {
  std::vector<std::byte> bytes;
  std::vector<SentPacket> packets;
};

/// A packet with every field drawn at random; `seq` tells it from the others.
inline SentPacket random_packet(Random& random, std::uint32_t seq, int channels) {
  SentPacket packet;
  FrameHeader& h = packet.header;
  h.seq = seq;
  h.flags = static_cast<std::uint16_t>(random() & 0x3FU);
  h.frame = static_cast<std::uint32_t>(random());
  h.t_ns = random();
  h.config_id = static_cast<std::uint32_t>(random());
  h.illum = static_cast<std::uint8_t>(random());
  h.temperature = static_cast<std::int16_t>(random());
  h.dropped = static_cast<std::uint16_t>(random());
  if (below(random, 8) == 0) {
    h.type = below(random, 2) == 0 ? PacketType::event : PacketType::log;
    packet.payload = random_bytes(random, below(random, 40));
  } else {
    h.format = all_formats[below(random, all_formats.size())];
    h.first_ch = static_cast<std::uint16_t>(below(random, static_cast<std::size_t>(channels)));
    h.n_ch = static_cast<std::uint16_t>(1 + below(random, static_cast<std::size_t>(channels) - h.first_ch));
    packet.payload = random_bytes(random, packed_bytes(h.format, h.n_ch));
    // The nastiest content: what looks like a packet's beginning.
    if (below(random, 4) == 0 && packet.payload.size() >= 4) {
      std::copy_n(std::array{std::byte{'C'}, std::byte{'E'}, std::byte{'Y'}, std::byte{'E'}}.begin(), 4,
                  packet.payload.begin() + static_cast<std::ptrdiff_t>(below(random, packet.payload.size() - 3)));
    }
  }
  h.payload_bytes = static_cast<std::uint16_t>(packet.payload.size());
  return packet;
}

inline void append(SentStream& stream, SentPacket packet) {
  packet.at = stream.bytes.size();
  stream.bytes.resize(packet.end());
  encode_packet(packet.header, packet.payload, std::span(stream.bytes).subspan(packet.at));
  stream.packets.push_back(std::move(packet));
}

inline SentStream random_stream(Random& random, std::uint32_t packets, int channels) {
  SentStream stream;
  for (std::uint32_t seq = 0; seq < packets; ++seq) append(stream, random_packet(random, seq, channels));
  return stream;
}

/// Cuts `bytes` into chunks of random sizes, some of one byte and some empty, and hands each to `use`.
template <class Use>
void in_random_chunks(Random& random, std::span<const std::byte> bytes, std::size_t longest, Use&& use) {
  while (!bytes.empty()) {
    const std::size_t most = below(random, 3) == 0 ? 3 : longest;
    const std::size_t size = std::min(below(random, most + 1), bytes.size());
    use(bytes.first(size));
    bytes = bytes.subspan(size);
  }
}

}  // namespace compueye::protocol::tests
