#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/accounting.hpp"

/// The numbers of docs/recordings.md, version 1 of the format. All integers little-endian.
namespace compueye::recording {

inline constexpr std::array<char, 8> file_magic{'C', 'E', 'Y', 'E', 'R', 'E', 'C', '\n'};
inline constexpr std::array<char, 4> block_magic{'C', 'E', 'Y', 'R'};
inline constexpr std::uint16_t format_version = 1;

inline constexpr std::size_t crc_bytes = 4;
inline constexpr std::size_t fixed_header_bytes = 48;  ///< of the file, before its texts
inline constexpr std::size_t block_head_bytes = 124;   ///< with its own CRC
inline constexpr std::size_t end_block_bytes = block_head_bytes + crc_bytes;

// What a reader accepts; a writer refuses more. Counters and times have room for sums of them.
inline constexpr int most_channels = 65'536;
inline constexpr int most_bits = 24;
inline constexpr std::size_t most_text_bytes = 255;
inline constexpr std::size_t most_settings_bytes = 65'535;
inline constexpr std::uint64_t most_count = (std::uint64_t{1} << 56U) - 1;
inline constexpr std::int64_t most_arrival_ns = (std::int64_t{1} << 62U) - 1;

inline constexpr std::size_t recorded_reasons = 8;
static_assert(hal::drop_reason_count == recorded_reasons, "docs/recordings.md lists the reasons by number");

/// Bytes of one code: the fewest whole ones that hold `bits`, at least two.
[[nodiscard]] constexpr std::size_t code_bytes(int bits) noexcept {
  return bits <= 16 ? 2 : 3;
}
[[nodiscard]] constexpr std::size_t validity_bytes(std::size_t channels) noexcept {
  return (channels + 7) / 8;
}
[[nodiscard]] constexpr std::size_t frame_block_bytes(std::size_t channels, int bits) noexcept {
  return block_head_bytes + validity_bytes(channels) + channels * code_bytes(bits) + crc_bytes;
}

}  // namespace compueye::recording
