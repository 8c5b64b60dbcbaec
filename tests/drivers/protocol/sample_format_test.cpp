#include "drivers/protocol/sample_format.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "tests/drivers/protocol/wire_samples.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;

TEST_CASE("samples survive packing at every format, depth and count") {
  Random random(5);
  for (const SampleFormat format : all_formats) {
    for (int bits = 1; bits <= most_bits(format); ++bits) {
      for (std::size_t count = 1; count <= 40; ++count) {
        CAPTURE(name(format));
        CAPTURE(bits);
        CAPTURE(count);
        auto codes = random_codes(random, count, bits);
        codes[below(random, count)] = static_cast<std::int32_t>((1U << bits) - 1U);
        std::vector<std::byte> packed(packed_bytes(format, count));
        REQUIRE(pack(format, codes, bits, packed));
        std::vector<std::int32_t> back(count, -1);
        std::vector<std::uint8_t> valid(count, 7);
        REQUIRE(unpack(format, packed, bits, back, valid) == count);
        REQUIRE(back == codes);
        REQUIRE(std::count(valid.begin(), valid.end(), 1) == static_cast<std::ptrdiff_t>(count));
      }
    }
  }
}

TEST_CASE("the bytes of each format are those of the specification") {
  const auto bytes = [](std::initializer_list<unsigned> values) {
    std::vector<std::byte> all;
    for (const unsigned v : values) all.push_back(static_cast<std::byte>(v));
    return all;
  };
  const auto packed = [](SampleFormat format, std::vector<std::int32_t> codes, int bits) {
    std::vector<std::byte> all(packed_bytes(format, codes.size()));
    REQUIRE(pack(format, codes, bits, all));
    return all;
  };
  CHECK(packed(SampleFormat::u16, {0x1234, 0xFFFF}, 16) == bytes({0x34, 0x12, 0xFF, 0xFF}));
  CHECK(packed(SampleFormat::u12, {0x123, 0xABC, 0xFED}, 12) == bytes({0x23, 0xC1, 0xAB, 0xED, 0x0F}));
  // 0 is the most negative value, 2^(bits-1) is zero.
  CHECK(packed(SampleFormat::i24, {0, 0x800000, 0xFFFFFF}, 24) ==
        bytes({0x00, 0x00, 0x80, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0x7F}));
  CHECK(packed(SampleFormat::i24, {0, 512, 1023}, 10) == bytes({0x00, 0xFE, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0x01, 0x00}));
}

TEST_CASE("a code beyond the depth is made invalid and harms no other") {
  Random random(6);
  for (const SampleFormat format : all_formats) {
    const int deep = most_bits(format), bits = deep - 3;
    for (int trial = 0; trial < 200; ++trial) {
      const std::size_t count = 1 + below(random, 50);
      const auto bytes = random_bytes(random, packed_bytes(format, count));
      std::vector<std::int32_t> all(count), codes(count, -1);
      std::vector<std::uint8_t> valid(count), all_valid(count);
      REQUIRE(unpack(format, bytes, deep, all, all_valid) == count);
      const std::size_t good = unpack(format, bytes, bits, codes, valid);
      REQUIRE(good == static_cast<std::size_t>(std::count(valid.begin(), valid.end(), 1)));
      for (std::size_t k = 0; k < count; ++k) {
        // i24 is centred: its full depth is offset by 2^(deep-1), the shallower one by 2^(bits-1).
        const std::int32_t code = format == SampleFormat::i24 ? all[k] - (1 << (deep - 1)) + (1 << (bits - 1)) : all[k];
        const bool fits = code >= 0 && code < (1 << bits);
        REQUIRE(valid[k] == (fits ? 1 : 0));
        REQUIRE(codes[k] == (fits ? code : 0));
      }
    }
  }
}

TEST_CASE("sizes that do not fit are refused and write nothing") {
  std::vector<std::int32_t> codes(5, 42);
  std::vector<std::uint8_t> valid(5, 9);
  std::vector<std::byte> packed(64, std::byte{3});
  for (const SampleFormat format : all_formats) {
    for (std::size_t size = 0; size < 20; ++size) {
      if (size == packed_bytes(format, 5)) continue;
      CHECK(unpack(format, std::span(packed).first(size), 12, codes, valid) == 0);
      CHECK_FALSE(pack(format, codes, 12, std::span(packed).first(size)));
    }
    CHECK(unpack(format, std::span(packed).first(packed_bytes(format, 5)), 12, codes, std::span(valid).first(4)) == 0);
  }
  const auto unknown = static_cast<SampleFormat>(9);
  CHECK_FALSE(known(unknown));
  CHECK(packed_bytes(unknown, 5) == 0);
  CHECK(unpack(unknown, {}, 12, codes, valid) == 0);
  CHECK_FALSE(pack(unknown, codes, 12, {}));
  CHECK(codes == std::vector<std::int32_t>(5, 42));
  CHECK(valid == std::vector<std::uint8_t>(5, 9));
  CHECK(std::count(packed.begin(), packed.end(), std::byte{3}) == 64);
}

TEST_CASE("formats have names") {
  std::set<std::string_view> names;
  for (const SampleFormat format : all_formats) CHECK(names.insert(name(format)).second);
  CHECK(name(static_cast<SampleFormat>(0)) == "unknown");
}
