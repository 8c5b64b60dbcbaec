#include <doctest/doctest.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/protocol/crc16.hpp"
#include "drivers/protocol/crc32c.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;

namespace {

/// By the definition, a bit at a time.
std::uint32_t bitwise_crc32c(std::span<const std::byte> data) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::byte b : data) {
    crc ^= std::to_integer<std::uint32_t>(b);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0x82F63B78U : 0U);
  }
  return ~crc;
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

}  // namespace

TEST_CASE("CRC-32C gives the vectors of RFC 3720, B.4") {
  std::vector<std::byte> zeros(32), ones(32, std::byte{0xFF}), up(32), down(32);
  for (std::size_t k = 0; k < 32; ++k) {
    up[k] = static_cast<std::byte>(k);
    down[k] = static_cast<std::byte>(31 - k);
  }
  // An iSCSI SCSI Read (10) command.
  std::vector<std::byte> read_command(48);
  for (const auto& [at, value] : std::initializer_list<std::pair<std::size_t, unsigned>>{
           {0, 0x01}, {1, 0xC0}, {16, 0x14}, {22, 0x04}, {27, 0x14}, {31, 0x18}, {32, 0x28}, {40, 0x02}}) {
    read_command[at] = static_cast<std::byte>(value);
  }
  const std::pair<std::span<const std::byte>, std::uint32_t> vectors[] = {{zeros, 0x8A9136AAU},
                                                                          {ones, 0x62A8AB43U},
                                                                          {up, 0x46DD794EU},
                                                                          {down, 0x113FDB5CU},
                                                                          {read_command, 0xD9963A56U},
                                                                          {bytes_of("123456789"), 0xE3069283U},
                                                                          {{}, 0U}};
  for (const auto& [data, expected] : vectors) {
    CHECK(crc32c(data) == expected);
    CHECK(crc32c_by_table(data) == expected);
    CHECK(bitwise_crc32c(data) == expected);
  }
}

TEST_CASE("CRC-32C by instruction, by table and by bits are the same at every length and address") {
  if (!crc32c_uses_hardware()) MESSAGE("this processor has no CRC instruction: the table is compared with itself");
  Random random(32);
  // Around the ends of the three-stream blocks of 3 * 128 and 3 * 1024 bytes, and a frame of 13 KiB.
  std::vector<std::size_t> lengths{3071, 3072, 3073, 3455, 3456, 3457, 6144, 12844};
  for (std::size_t length = 0; length < 1200; ++length) lengths.push_back(length);
  const auto data = random_bytes(random, 13000);
  for (const std::size_t length : lengths) {
    CAPTURE(length);
    const auto part = std::span(data).subspan(below(random, 9), length);
    const std::uint32_t expected = bitwise_crc32c(part);
    REQUIRE(crc32c(part) == expected);
    REQUIRE(crc32c_by_table(part) == expected);
    const std::size_t cut = below(random, length + 1);
    REQUIRE(crc32c(part.subspan(cut), crc32c(part.first(cut))) == expected);
  }
}

TEST_CASE("CRC-16 gives its catalogue's check value and chains") {
  CHECK(crc16(bytes_of("123456789")) == 0x29B1);
  CHECK(crc16({}) == 0xFFFF);
  CHECK(crc16(bytes_of("56789"), crc16(bytes_of("1234"))) == 0x29B1);
}
