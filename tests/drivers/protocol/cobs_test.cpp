#include "drivers/protocol/cobs.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "drivers/protocol/frame_header.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;

namespace {

std::vector<std::byte> bytes_of(std::initializer_list<unsigned> values) {
  std::vector<std::byte> all;
  for (const unsigned v : values) all.push_back(static_cast<std::byte>(v));
  return all;
}

std::vector<std::byte> encoded(std::span<const std::byte> data) {
  std::vector<std::byte> into(cobs_bytes(data.size()));
  into.resize(cobs_encode(data, into));
  return into;
}

/// Bytes in which zeros are `zeros_in_16` times as frequent as any other value.
std::vector<std::byte> some_bytes(Random& random, std::size_t count, std::size_t zeros_in_16) {
  auto bytes = random_bytes(random, count);
  for (std::byte& b : bytes) {
    if (below(random, 16) < zeros_in_16) b = std::byte{0};
    if (zeros_in_16 == 0 && b == std::byte{0}) b = std::byte{1};
  }
  return bytes;
}

}  // namespace

TEST_CASE("COBS gives the encodings of the paper's examples") {
  CHECK(encoded({}) == bytes_of({1}));
  CHECK(encoded(bytes_of({0})) == bytes_of({1, 1}));
  CHECK(encoded(bytes_of({0, 0})) == bytes_of({1, 1, 1}));
  CHECK(encoded(bytes_of({0x11, 0x22, 0, 0x33})) == bytes_of({3, 0x11, 0x22, 2, 0x33}));
  CHECK(encoded(bytes_of({0x11, 0, 0, 0})) == bytes_of({2, 0x11, 1, 1, 1}));
  const std::vector<std::byte> full(254, std::byte{7});
  CHECK(encoded(full).size() == 255);
  CHECK(encoded(full)[0] == std::byte{0xFF});
}

TEST_CASE("COBS brings back any bytes, without a zero on the way") {
  Random random(1);
  for (int trial = 0; trial < 3000; ++trial) {
    CAPTURE(trial);
    const std::size_t count = below(random, trial % 10 == 0 ? 1100 : 40), zeros = 5 * below(random, 4);
    const auto data = some_bytes(random, count, zeros);
    const auto wire = encoded(data);
    REQUIRE(std::find(wire.begin(), wire.end(), std::byte{0}) == wire.end());
    std::vector<std::byte> back(data.size());
    const auto length = cobs_decode(wire, back);
    REQUIRE(length);
    REQUIRE(*length == data.size());
    REQUIRE(back == data);
    auto in_place = wire;
    REQUIRE(cobs_decode(in_place, in_place) == data.size());
    REQUIRE(std::equal(data.begin(), data.end(), in_place.begin()));
    if (!data.empty()) {
      REQUIRE_FALSE(cobs_decode(wire, std::span(back).first(data.size() - 1)));
      REQUIRE_FALSE(cobs_decode(std::span(wire).first(wire.size() - 1), back).value_or(0) == data.size());
      std::vector<std::byte> small(cobs_bytes(data.size()) - 1);
      REQUIRE(cobs_encode(data, small) == 0);
    }
  }
  std::vector<std::byte> into(10);
  CHECK_FALSE(cobs_decode({}, into));
  CHECK_FALSE(cobs_decode(bytes_of({0}), into));
  CHECK_FALSE(cobs_decode(bytes_of({3, 1}), into));
  CHECK_FALSE(cobs_decode(bytes_of({3, 0, 1}), into));
}

TEST_CASE("the decoder finds frames in a damaged stream cut anywhere, and no false ones of a packet's kind") {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    std::vector<std::vector<std::byte>> sent;
    std::vector<std::byte> wire;
    std::size_t too_long = 0;
    for (int f = 0; f < 20; ++f) {
      const bool long_one = below(random, 10) == 0;
      auto data = some_bytes(random, long_one ? 150 + below(random, 400) : 1 + below(random, 100), 1);
      const auto coded = encoded(data);
      wire.insert(wire.end(), coded.begin(), coded.end());
      wire.push_back(std::byte{0});
      if (below(random, 4) == 0) wire.push_back(std::byte{0});
      if (long_one) {
        ++too_long;
      } else {
        sent.push_back(std::move(data));
      }
    }
    CobsDecoder decoder(100);
    std::vector<std::vector<std::byte>> got;
    in_random_chunks(random, wire, 300, [&](std::span<const std::byte> chunk) {
      decoder.feed(chunk);
      while (const auto frame = decoder.next()) got.emplace_back(frame->begin(), frame->end());
    });
    REQUIRE(got == sent);
    REQUIRE(decoder.counters().frames == sent.size());
    REQUIRE(decoder.counters().too_long == too_long);
    REQUIRE(decoder.counters().broken == 0);
  }
  CobsDecoder decoder(10);
  const auto broken = bytes_of({9, 1, 2, 0, 2, 7, 0});
  decoder.feed(broken);
  const auto frame = decoder.next();
  REQUIRE(frame);
  CHECK(frame->size() == 1);
  CHECK(decoder.counters().broken == 1);
  CHECK(decoder.counters().skipped_bytes == 3);
}
