#include "drivers/protocol/packet_stream.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "tests/drivers/protocol/wire_samples.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;

namespace {

constexpr int streamed_channels = 60;
constexpr PacketLimits limits{streamed_channels, 3 * streamed_channels};
constexpr std::size_t longest_packet = least_packet_bytes + 3 * streamed_channels;

struct Got {
  FrameHeader header;
  std::vector<std::byte> payload;
  std::size_t skipped_before = 0;
};

/// Everything that `parser` makes of `bytes` in random chunks, each chunk in memory of its own that is gone afterwards.
std::vector<Got> parse(PacketStream& parser, Random& random, std::span<const std::byte> bytes,
                       std::size_t longest_chunk) {
  std::vector<Got> all;
  in_random_chunks(random, bytes, longest_chunk, [&](std::span<const std::byte> chunk) {
    const std::vector<std::byte> own(chunk.begin(), chunk.end());
    parser.feed(own);
    while (const auto packet = parser.next()) {
      all.push_back({packet->header, {packet->payload.begin(), packet->payload.end()}, packet->skipped_before});
    }
  });
  return all;
}

bool same(const Got& got, const SentPacket& sent) {
  return got.header == sent.header && got.payload == sent.payload;
}

/// Damages `bytes` and says which of them are still what was sent: original position of each, or nothing.
struct Damaged {
  std::vector<std::byte> bytes;
  std::vector<std::size_t> from;
  static constexpr std::size_t nowhere = ~std::size_t{0};
};

Damaged undamaged(std::span<const std::byte> bytes) {
  Damaged d{{bytes.begin(), bytes.end()}, std::vector<std::size_t>(bytes.size())};
  std::iota(d.from.begin(), d.from.end(), std::size_t{0});
  return d;
}

void damage(Damaged& d, Random& random) {
  if (d.bytes.empty()) return;
  const std::size_t at = below(random, d.bytes.size());
  const std::size_t length = std::min(1 + below(random, below(random, 4) == 0 ? 400 : 8), d.bytes.size() - at);
  const auto begin = static_cast<std::ptrdiff_t>(at), end = static_cast<std::ptrdiff_t>(at + length);
  switch (below(random, 5)) {
    case 0:  // one bit
      d.bytes[at] ^= static_cast<std::byte>(1U << below(random, 8));
      d.from[at] = Damaged::nowhere;
      break;
    case 1:  // bytes lost
      d.bytes.erase(d.bytes.begin() + begin, d.bytes.begin() + end);
      d.from.erase(d.from.begin() + begin, d.from.begin() + end);
      break;
    case 2: {  // garbage in between
      const auto garbage = random_bytes(random, length);
      d.bytes.insert(d.bytes.begin() + begin, garbage.begin(), garbage.end());
      d.from.insert(d.from.begin() + begin, length, Damaged::nowhere);
      break;
    }
    case 3:  // stuck at one value
      std::fill(d.bytes.begin() + begin, d.bytes.begin() + end, std::byte{0});
      std::fill(d.from.begin() + begin, d.from.begin() + end, Damaged::nowhere);
      break;
    default: {  // a piece of the stream again, in the middle of it: old memory of the device
      const std::vector<std::byte> again(d.bytes.begin() + begin, d.bytes.begin() + end);
      const auto into = static_cast<std::ptrdiff_t>(below(random, d.bytes.size()));
      d.bytes.insert(d.bytes.begin() + into, again.begin(), again.end());
      d.from.insert(d.from.begin() + into, again.size(), Damaged::nowhere);
    }
  }
}

/// Packets of which every byte is still there, in order and together.
std::vector<std::uint32_t> untouched(const SentStream& stream, const Damaged& d) {
  std::vector<std::uint32_t> whole;
  for (const SentPacket& packet : stream.packets) {
    const auto begin = std::find(d.from.begin(), d.from.end(), packet.at);
    const std::size_t length = packet.header.packet_bytes();
    if (static_cast<std::size_t>(d.from.end() - begin) < length) continue;
    bool together = true;
    for (std::size_t k = 0; k < length && together; ++k)
      together = begin[static_cast<std::ptrdiff_t>(k)] == packet.at + k;
    if (together) whole.push_back(packet.header.seq);
  }
  return whole;
}

void check_books(const PacketStream& parser, std::size_t fed) {
  const StreamCounters& c = parser.counters();
  REQUIRE(c.packet_bytes + c.skipped_bytes + parser.pending_bytes() == fed);
}

}  // namespace

TEST_CASE("a good stream gives the same packets however it is cut into chunks") {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const SentStream stream = random_stream(random, 40, streamed_channels);
    PacketStream parser(limits);
    const auto got = parse(parser, random, stream.bytes, 1 + below(random, 2000));
    REQUIRE(got.size() == stream.packets.size());
    for (std::size_t k = 0; k < got.size(); ++k) {
      REQUIRE(same(got[k], stream.packets[k]));
      REQUIRE(got[k].skipped_before == 0);
    }
    const StreamCounters& c = parser.counters();
    REQUIRE(c.skipped_bytes + c.crc_errors + c.bad_headers + c.resyncs == 0);
    REQUIRE(parser.pending_bytes() == 0);
    check_books(parser, stream.bytes.size());
  }
}

TEST_CASE("damage anywhere: nothing false is accepted, every whole packet is found, the bytes add up") {
  std::uint64_t resyncs = 0, lost = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const SentStream stream = random_stream(random, 25, streamed_channels);
    Damaged damaged = undamaged(stream.bytes);
    for (std::size_t k = 1 + below(random, 6); k > 0; --k) damage(damaged, random);
    const std::vector<std::uint32_t> whole = untouched(stream, damaged);
    // So that a false beginning near the end does not wait for more for ever.
    damaged.bytes.resize(damaged.bytes.size() + longest_packet);

    PacketStream parser(limits);
    const auto got = parse(parser, random, damaged.bytes, 1 + below(random, 1500));
    std::vector<std::uint32_t> found;
    std::size_t skipped_between = 0;
    for (const Got& g : got) {
      REQUIRE(g.header.seq < stream.packets.size());
      REQUIRE(same(g, stream.packets[g.header.seq]));
      found.push_back(g.header.seq);
      skipped_between += g.skipped_before;
    }
    // A repeated piece may bring a packet twice; but every whole one is there, in order.
    REQUIRE(std::all_of(whole.begin(), whole.end(),
                        [&](auto seq) { return std::find(found.begin(), found.end(), seq) != found.end(); }));
    check_books(parser, damaged.bytes.size());
    REQUIRE(skipped_between <= parser.counters().skipped_bytes);
    resyncs += parser.counters().resyncs;
    lost += stream.packets.size() - whole.size();
  }
  // The damage was real.
  CHECK(resyncs > 2000);
  CHECK(lost > 2000);
}

TEST_CASE("one turned bit costs the packet that it is in and no other") {
  Random random(9);
  const SentStream stream = random_stream(random, 3, streamed_channels);
  for (std::size_t bit = 0; bit < 8 * stream.bytes.size(); ++bit) {
    CAPTURE(bit);
    auto bytes = stream.bytes;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    bytes.resize(bytes.size() + longest_packet);
    PacketStream parser(limits);
    parser.feed(bytes);
    std::size_t packets = 0;
    while (const auto packet = parser.next()) {
      ++packets;
      const SentPacket& sent = stream.packets[packet->header.seq];
      REQUIRE_FALSE((bit / 8 >= sent.at && bit / 8 < sent.end()));
    }
    REQUIRE(packets == 2);
  }
}

TEST_CASE("a packet that lies whole in a chunk is not copied, one that does not is") {
  Random random(3);
  const SentStream stream = random_stream(random, 2, streamed_channels);
  PacketStream parser(limits);
  parser.feed(stream.bytes);
  const auto whole = parser.next();
  REQUIRE(whole);
  CHECK(whole->payload.data() == stream.bytes.data() + header_bytes);
  const std::size_t second_at = stream.packets[1].at;
  for (std::size_t cut = second_at + 1; cut < stream.bytes.size(); ++cut) {
    PacketStream split(limits);
    split.feed(std::span(stream.bytes).first(cut));
    REQUIRE(split.next());
    REQUIRE_FALSE(split.next());
    REQUIRE(split.pending_bytes() == cut - second_at);
    split.feed(std::span(stream.bytes).subspan(cut));
    const auto packet = split.next();
    REQUIRE(packet);
    REQUIRE(same({packet->header, {packet->payload.begin(), packet->payload.end()}}, stream.packets[1]));
    const bool in_place = packet->payload.data() >= stream.bytes.data() &&
                          packet->payload.data() < stream.bytes.data() + stream.bytes.size();
    REQUIRE_FALSE(in_place);
  }
}

TEST_CASE("what looks like packets and is none ends, within the work that is promised") {
  std::array<std::byte, header_bytes> header{};
  FrameHeader h;
  h.n_ch = streamed_channels;
  h.format = SampleFormat::i24;
  h.payload_bytes = 3 * streamed_channels;
  store(h, header);
  std::vector<std::byte> headers, magics;
  for (int k = 0; k < 500; ++k) {
    headers.insert(headers.end(), header.begin(), header.end());
    magics.insert(magics.end(), header.begin(), header.begin() + 4);
  }
  Random random(4);
  PacketStream on_headers(limits), on_magics(limits);
  CHECK(parse(on_headers, random, headers, 300).empty());
  CHECK(parse(on_magics, random, magics, 300).empty());
  check_books(on_headers, headers.size());
  check_books(on_magics, magics.size());
  CHECK(on_headers.counters().crc_errors > 400);
  CHECK(on_headers.counters().crc_errors <= 500);
  CHECK(on_magics.counters().bad_headers > 400);
  CHECK(on_headers.pending_bytes() < longest_packet);
  CHECK(on_magics.pending_bytes() < header_bytes);
}

TEST_CASE("hostile garbage is looked through in pieces of bounded work, and a packet behind it is found") {
  constexpr PacketLimits wide{65535, 65535};
  std::vector<std::byte> bytes(std::size_t{1} << 16U);
  FrameHeader hostile;
  hostile.n_ch = 32760;
  hostile.payload_bytes = 65520;
  for (std::size_t at = 0; at + header_bytes <= bytes.size() / 2; at += header_bytes) {
    store(hostile, std::span(bytes).subspan(at).first<header_bytes>());
  }
  const std::array<std::int32_t, 4> codes{1, 2, 3, 4};
  FrameHeader sent;
  sent.frame = 77;
  REQUIRE(encode_data(sent, codes, 12, std::span(bytes).last(100)) > 0);
  bytes.resize(bytes.size() + 65564);  // the CRC that each of them wants

  PacketStream parser(wide);
  parser.feed(bytes);
  constexpr std::size_t most = std::size_t{1} << 20U;
  int calls = 0;
  std::optional<Packet> packet;
  do {
    const std::uint64_t before = parser.counters().crc_errors;
    std::size_t crc_bytes = most;
    packet = parser.next(crc_bytes);
    CHECK(parser.counters().crc_errors - before <= most / 65564 + 1);
    REQUIRE(++calls < 1000);
  } while (!packet && parser.has_more());
  REQUIRE(packet);
  CHECK(packet->header.frame == 77);
  CHECK(calls > 40);
  CHECK_FALSE(parser.has_more());
}

TEST_CASE("an abandoned chunk and a reset count as skipped") {
  Random random(8);
  const SentStream stream = random_stream(random, 4, streamed_channels);
  PacketStream parser(limits);
  parser.feed(stream.bytes);
  REQUIRE(parser.next());
  parser.feed(std::span(stream.bytes).first(10));
  CHECK(parser.counters().skipped_bytes == stream.bytes.size() - stream.packets[0].end());
  CHECK_FALSE(parser.next());
  CHECK(parser.pending_bytes() == 10);
  parser.reset();
  CHECK(parser.pending_bytes() == 0);
  check_books(parser, stream.bytes.size() + 10);
  parser.feed(stream.bytes);
  const auto first = parser.next();
  REQUIRE(first);
  CHECK(first->skipped_before == stream.bytes.size() - stream.packets[0].end() + 10);
  CHECK(parser.counters().resyncs == 1);
}

TEST_CASE("limits beyond the format's own are brought back to it") {
  const PacketStream parser({1'000'000, 1'000'000});
  CHECK(parser.limits().channels == most_channels);
  CHECK(parser.limits().payload_bytes == most_payload_bytes);
  CHECK(PacketStream({-5, 0}).limits().channels == 1);
}

TEST_CASE("the encoder refuses what does not fit and writes nothing") {
  std::vector<std::byte> into(100, std::byte{5});
  std::vector<std::int32_t> codes(40);
  FrameHeader h;
  CHECK(encode_packet(h, std::vector<std::byte>(57), into) == 0);
  std::vector<std::byte> large(70000);
  CHECK(encode_packet(h, std::span(large).first(65536), large) == 0);
  CHECK(encode_data(h, codes, 16, into) == 0);
  CHECK(encode_data(h, {}, 16, into) == 0);
  h.format = static_cast<SampleFormat>(7);
  CHECK(encode_data(h, std::span(codes).first(2), 16, into) == 0);
  CHECK(std::count(into.begin(), into.end(), std::byte{5}) == 100);
  for (const SampleFormat format : all_formats) {
    for (const std::size_t payload : {3U, 4U, 5U, 6U, 60U, 12800U, 65535U}) {
      const auto fit = static_cast<std::size_t>(channels_in(format, payload));
      CHECK(packed_bytes(format, fit) <= payload);
      CHECK(packed_bytes(format, fit + 1) > payload);
    }
  }
}
