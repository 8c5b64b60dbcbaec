// The decoder of the USB stream: bytes to packets to frames.

#include <algorithm>
#include <vector>

#include "drivers/protocol/frame_assembler.hpp"
#include "drivers/protocol/packet_encoder.hpp"
#include "drivers/protocol/packet_stream.hpp"
#include "tests/fuzz/block_invariants.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace compueye;
using namespace compueye::fuzz;

namespace {

std::vector<std::byte> encoded(const protocol::Packet& packet) {
  std::vector<std::byte> bytes(packet.header.packet_bytes());
  protocol::encode_packet(packet.header, packet.payload, bytes);
  return bytes;
}

/// The bytes as a stream; and as headers with a payload length, which get the magic number and CRC that a fuzzer does
/// not guess.
std::vector<std::byte> stream_bytes(Input& input, bool sealed, const protocol::PacketLimits& limits) {
  std::vector<std::byte> bytes;
  while (!input.empty()) {
    if (!sealed) {
      const auto raw = input.take(input.size());
      bytes.insert(bytes.end(), raw.begin(), raw.end());
      break;
    }
    std::byte header_bytes[protocol::header_bytes] = {};
    const auto raw = input.take(protocol::header_bytes);
    std::copy(raw.begin(), raw.end(), header_bytes);
    protocol::FrameHeader header = protocol::load_header(header_bytes);
    header.version = protocol::host_version;
    if (header.type == protocol::PacketType::data) {
      header.first_ch = static_cast<std::uint16_t>(header.first_ch % limits.channels);
      header.n_ch = static_cast<std::uint16_t>(1 + header.n_ch % (limits.channels - header.first_ch));
      header.format = static_cast<protocol::SampleFormat>(1 + static_cast<unsigned>(header.format) % 3);
      header.payload_bytes = static_cast<std::uint16_t>(protocol::packed_bytes(header.format, header.n_ch));
    } else {
      header.payload_bytes %= 64;
    }
    header.config_id %= 2;
    header.frame %= header.illum < 8 ? 0xFFFFFFFFU : 16U;
    std::vector<std::byte> payload(header.payload_bytes);
    const auto some = input.take(payload.size());
    std::copy(some.begin(), some.end(), payload.begin());
    const auto packet = encoded({header, payload, 0});
    bytes.insert(bytes.end(), packet.begin(), packet.end());
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const bool sealed = input.byte() % 2 == 1;
  const int channels = 1 + input.byte() % 40, bits = 1 + input.byte() % 24;
  const std::size_t chunk = 1 + input.word() % 600;
  const protocol::PacketLimits limits{channels, 3U * 40U};
  const auto bytes = stream_bytes(input, sealed, limits);

  protocol::PacketStream stream(limits), in_one(limits);
  protocol::FrameAssembler assembler(channels, bits);
  assembler.begin_run();
  assembler.begin_stream(1, bits * 1000);
  std::vector<std::vector<std::byte>> packets;
  std::optional<hal::SampleBlock> last;
  auto searched_from = bytes.begin();
  for (std::size_t at = 0; at < bytes.size(); at += chunk) {
    // Of its own size, so that a sanitizer sees a step over its end.
    const std::vector<std::byte> own(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at + chunk, bytes.size())));
    stream.feed(own);
    while (const auto packet = stream.next()) {
      invariant(protocol::plausible(packet->header, limits), "an accepted header is plausible");
      packets.push_back(encoded(*packet));
      const auto found = std::search(searched_from, bytes.end(), packets.back().begin(), packets.back().end());
      invariant(found != bytes.end(), "an accepted packet stands in the stream, byte for byte, after the one before");
      searched_from = found + static_cast<std::ptrdiff_t>(packets.back().size());
      assembler.push(*packet);
      check_blocks(assembler, static_cast<std::size_t>(channels), bits, last);
    }
  }
  const protocol::StreamCounters& c = stream.counters();
  invariant(c.packet_bytes + c.skipped_bytes + stream.pending_bytes() == bytes.size(), "every byte is accounted for");

  in_one.feed(bytes);
  std::size_t count = 0;
  while (const auto packet = in_one.next()) {
    invariant(count < packets.size() && encoded(*packet) == packets[count], "chunks do not change what is found");
    ++count;
  }
  invariant(count == packets.size(), "chunks do not change how much is found");
  assembler.flush();
  check_blocks(assembler, static_cast<std::size_t>(channels), bits, last);
  return 0;
}
