#include "drivers/protocol/crc16.hpp"

#include <array>

namespace compueye::protocol {
namespace {

constexpr std::array<std::uint16_t, 256> make_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned b = 0; b < 256; ++b) {
    unsigned crc = b << 8U;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1U) ^ ((crc & 0x8000U) != 0 ? 0x1021U : 0U);
    table[b] = static_cast<std::uint16_t>(crc);
  }
  return table;
}
constexpr std::array<std::uint16_t, 256> table = make_table();

}  // namespace

std::uint16_t crc16(std::span<const std::byte> data, std::uint16_t previous) noexcept {
  unsigned crc = previous;
  for (const std::byte b : data) crc = (crc << 8U & 0xFFFFU) ^ table[(crc >> 8U) ^ std::to_integer<unsigned>(b)];
  return static_cast<std::uint16_t>(crc);
}

}  // namespace compueye::protocol
