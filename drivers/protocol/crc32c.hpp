#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace compueye::protocol {

/// CRC-32C (Castagnoli): polynomial 0x1EDC6F41, reflected, start and final exclusive-or 0xFFFFFFFF; "123456789" gives
/// 0xE3069283. Source: RFC 3720, appendix B.4.
///
/// The processor's instruction (SSE 4.2, ARMv8 CRC) where there is one, found once at run time, and a table elsewhere:
/// the result is the same. Over a message in parts: crc32c(b, crc32c(a)) is the CRC of a followed by b.
[[nodiscard]] std::uint32_t crc32c(std::span<const std::byte> data, std::uint32_t previous = 0) noexcept;

/// True when crc32c() uses the processor's instruction.
[[nodiscard]] bool crc32c_uses_hardware() noexcept;

/// The same by table (slicing by 8) on every processor.
[[nodiscard]] std::uint32_t crc32c_by_table(std::span<const std::byte> data, std::uint32_t previous = 0) noexcept;

}  // namespace compueye::protocol
