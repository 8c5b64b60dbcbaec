#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace compueye::protocol {

/// CRC-16/IBM-3740 ("CCITT-FALSE"): polynomial 0x1021, start 0xFFFF, not reflected, no final exclusive-or; "123456789"
/// gives 0x29B1. Over a message in parts: crc16(b, crc16(a)). Source: the catalogue of parametrised CRC algorithms.
[[nodiscard]] std::uint16_t crc16(std::span<const std::byte> data, std::uint16_t previous = 0xFFFF) noexcept;

}  // namespace compueye::protocol
