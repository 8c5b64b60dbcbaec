#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace compueye::protocol {

/// SET_ILLUM's payload, 8 bytes. Packets carry `tag` in FrameHeader::illum from the first frame on whose whole exposure
/// sees the light settled, and illumination_changing until then.
struct Illumination {
  static constexpr std::size_t bytes = 8;
  std::uint8_t illuminator = 0;  ///< id of the descriptor
  std::uint8_t tag = 0;          ///< the host's name for this light: 0 .. 254
  std::uint16_t level = 0;       ///< 0 off .. levels - 1 full
  std::uint32_t settle_ns = 0;   ///< waits longer than the descriptor says; a shorter time is raised to that
  friend bool operator==(const Illumination&, const Illumination&) noexcept = default;
};

void store(const Illumination& illumination, std::span<std::byte, Illumination::bytes> bytes) noexcept;
[[nodiscard]] Illumination load_illumination(std::span<const std::byte, Illumination::bytes> bytes) noexcept;

}  // namespace compueye::protocol
