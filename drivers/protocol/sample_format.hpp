#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace compueye::protocol {

/// How samples are packed into bytes. The values are those of the wire.
enum class SampleFormat : std::uint8_t {
  u16 = 1,  ///< two bytes a code, little-endian
  u12 = 2,  ///< two codes in three bytes, least significant bit first; an odd last code takes two, high nibble 0
  i24 = 3,  ///< three bytes, two's complement, little-endian: the code minus 2^(bits-1)
};

[[nodiscard]] std::string_view name(SampleFormat format) noexcept;  ///< "u16", "u12", "i24"
[[nodiscard]] bool known(SampleFormat format) noexcept;             ///< a byte of the wire may be none of them

/// The deepest codes a format can carry: 16, 12, 24; 0 for an unknown one.
[[nodiscard]] int most_bits(SampleFormat format) noexcept;

/// Bytes of `count` packed codes; 0 for an unknown format.
[[nodiscard]] std::size_t packed_bytes(SampleFormat format, std::size_t count) noexcept;

/// Unpacks codes.size() codes of `bits` bits (1 .. 24). `packed` holds exactly packed_bytes(format, codes.size())
/// bytes, `valid` as many entries as `codes`. A code outside 0 .. 2^bits - 1 is not believed: code 0, valid 0; all
/// others get valid 1. Returns the number of valid codes; 0, with nothing written, when the sizes do not fit.
std::size_t unpack(SampleFormat format, std::span<const std::byte> packed, int bits, std::span<std::int32_t> codes,
                   std::span<std::uint8_t> valid) noexcept;

/// Packs codes 0 .. 2^bits - 1 into exactly packed_bytes(format, codes.size()) bytes; higher bits are cut off. False,
/// with nothing written, when `packed` has another size.
bool pack(SampleFormat format, std::span<const std::int32_t> codes, int bits, std::span<std::byte> packed) noexcept;

}  // namespace compueye::protocol
