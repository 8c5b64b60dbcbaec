#pragma once

#include <cstdint>
#include <string_view>

#include "hal/result.hpp"

namespace compueye::protocol {

/// Version of the wire format, one byte on the wire: major in the high nibble, minor in the low one (docs/protocol.md,
/// "Versions").
struct ProtocolVersion {
  std::uint8_t major_number = 1;  ///< 0 .. 15; another one is another language
  std::uint8_t minor_number = 0;  ///< 0 .. 15; a higher one only adds what an older peer may ignore

  [[nodiscard]] constexpr std::uint8_t byte() const noexcept {
    return static_cast<std::uint8_t>((major_number & 0xFU) << 4U | (minor_number & 0xFU));
  }
  [[nodiscard]] static constexpr ProtocolVersion from_byte(std::uint8_t byte) noexcept {
    return {static_cast<std::uint8_t>(byte >> 4U), static_cast<std::uint8_t>(byte & 0xFU)};
  }
  friend constexpr bool operator==(ProtocolVersion, ProtocolVersion) noexcept = default;
};

/// What this code speaks.
inline constexpr ProtocolVersion host_version{1, 0};

enum class Compatibility : std::uint8_t { same, older_minor, newer_minor, other_major };

/// How a device of version `device` looks to this code. Everything but other_major can be used.
[[nodiscard]] Compatibility compatibility(ProtocolVersion device) noexcept;

/// Error unsupported for another major version: names both versions and which side to update. `place`: the serial.
[[nodiscard]] hal::Result<void> check_version(ProtocolVersion device, std::string_view place);

}  // namespace compueye::protocol
