#include "drivers/protocol/frame_header.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using compueye::hal::ErrorCode;
using compueye::test::check_error;

TEST_CASE("a header survives storing, at the limits of every field too") {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<std::byte, header_bytes> bytes{};
    // Any 40 bytes are a header; each byte is either random or at a limit.
    for (std::byte& b : bytes) {
      const std::size_t kind = below(random, 3);
      b = kind == 0 ? std::byte{0} : kind == 1 ? std::byte{0xFF} : static_cast<std::byte>(random());
    }
    const FrameHeader header = load_header(bytes);
    std::array<std::byte, header_bytes> stored{};
    store(header, stored);
    REQUIRE(load_header(stored) == header);
    // All but the magic number comes back.
    REQUIRE(std::equal(stored.begin() + 4, stored.end(), bytes.begin() + 4));
  }
}

TEST_CASE("each field lies where the specification puts it") {
  FrameHeader h;
  h.version = {1, 2};
  h.type = PacketType::event;
  h.flags = 0x0201;
  h.seq = 0x06050403;
  h.frame = 0x0A090807;
  h.t_ns = 0x1211100F0E0D0C0BU;
  h.config_id = 0x16151413;
  h.first_ch = 0x1817;
  h.n_ch = 0x1A19;
  h.format = SampleFormat::i24;
  h.illum = 0x1B;
  h.temperature = -2;
  h.payload_bytes = 0x1D1C;
  h.dropped = 0x1F1E;
  const std::array<unsigned, header_bytes> expected{'C',  'E',  'Y',  'E',  0x12, 0x02, 0x01, 0x02, 0x03, 0x04,
                                                    0x05, 0x06, 0x07, 0x08, 0x09, 0x0A, 0x0B, 0x0C, 0x0D, 0x0E,
                                                    0x0F, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18,
                                                    0x19, 0x1A, 0x03, 0x1B, 0xFE, 0xFF, 0x1C, 0x1D, 0x1E, 0x1F};
  std::array<std::byte, header_bytes> bytes{};
  store(h, bytes);
  for (std::size_t k = 0; k < header_bytes; ++k) {
    CAPTURE(k);
    CHECK(std::to_integer<unsigned>(bytes[k]) == expected[k]);
  }
  CHECK(h.packet_bytes() == 44 + 0x1D1C);
}

TEST_CASE("a header that contradicts itself or its limits is not plausible") {
  const PacketLimits limits{64, 128};
  FrameHeader good;
  good.n_ch = 64;
  good.payload_bytes = 128;
  REQUIRE(plausible(good, limits));
  const auto with = [&](auto change) {
    FrameHeader h = good;
    change(h);
    return plausible(h, limits);
  };
  CHECK_FALSE(with([](auto& h) { h.version = {2, 0}; }));
  CHECK_FALSE(with([](auto& h) { h.version = {0, 9}; }));
  CHECK(with([](auto& h) { h.version = {1, 15}; }));
  CHECK_FALSE(with([](auto& h) { h.format = static_cast<SampleFormat>(0); }));
  CHECK_FALSE(with([](auto& h) { h.format = static_cast<SampleFormat>(4); }));
  CHECK_FALSE(with([](auto& h) { h.format = SampleFormat::u12; }));
  CHECK_FALSE(with([](auto& h) { h.n_ch = 0; }));
  CHECK_FALSE(with([](auto& h) { h.n_ch = 63; }));
  CHECK_FALSE(with([](auto& h) { h.first_ch = 1; }));
  CHECK_FALSE(with([](auto& h) { h.first_ch = 65535; }));
  CHECK_FALSE(with([](auto& h) { h.payload_bytes = 127; }));
  CHECK_FALSE(plausible(good, {64, 127}));
  CHECK(with([](auto& h) { h.n_ch = 0, h.payload_bytes = 0, h.type = PacketType::log; }));
  CHECK(with([](auto& h) { h.type = static_cast<PacketType>(200); }));
  CHECK_FALSE(with([](auto& h) { h.type = PacketType::event, h.payload_bytes = 129; }));
}

TEST_CASE("versions: which devices this program can use") {
  CHECK(compatibility({1, 0}) == Compatibility::same);
  CHECK(compatibility({1, 5}) == Compatibility::newer_minor);
  CHECK(compatibility({0, 5}) == Compatibility::other_major);
  CHECK(compatibility({2, 0}) == Compatibility::other_major);
  CHECK(check_version({1, 15}, "x").has_value());
  const auto newer = check_version({2, 1}, "CE-9"), older = check_version({0, 3}, "CE-9");
  check_error(newer, ErrorCode::unsupported, "CE-9", {"2.1", "1.0"});
  check_error(older, ErrorCode::unsupported, "CE-9", {"0.3", "1.0"});
  // What to update is another thing for each.
  std::string other = older.error().sentence;
  REQUIRE(other.find("0.3") != std::string::npos);
  CHECK(other.replace(other.find("0.3"), 3, "2.1") != newer.error().sentence);
  for (unsigned byte = 0; byte < 256; ++byte) {
    CHECK(ProtocolVersion::from_byte(static_cast<std::uint8_t>(byte)).byte() == byte);
  }
}
