#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/sample_format.hpp"
#include "hal/result.hpp"

namespace compueye::protocol {

/// What a host may choose: SET_CONFIG's payload and GET_CONFIG's reply, 16 bytes.
struct Configuration {
  static constexpr std::size_t bytes = 16;

  std::uint32_t config_id =
      0;  ///< the host's choice, never 0; begin at random and count, so that no earlier run had it
  std::uint32_t frame_rate_mhz = 0;  ///< frames a second times 1000
  std::uint32_t exposure_ns = 0;     ///< per frame, at most the frame period
  SampleFormat format = SampleFormat::u16;

  [[nodiscard]] std::int64_t period_ns() const noexcept {
    return frame_rate_mhz == 0 ? 0 : std::int64_t{1'000'000'000'000} / frame_rate_mhz;
  }
  friend bool operator==(const Configuration&, const Configuration&) noexcept = default;
};

void store(const Configuration& configuration, std::span<std::byte, Configuration::bytes> bytes) noexcept;
[[nodiscard]] Configuration load_configuration(std::span<const std::byte, Configuration::bytes> bytes) noexcept;

/// Whether the device can do it. Error out_of_range names the field, the value and the limits.
[[nodiscard]] hal::Result<void> check_configuration(const Configuration& wanted, const DeviceDescriptor& device);

/// Compares what GET_CONFIG returned with what was set, byte for byte. Error mismatch names the first field that
/// differs with both values, bad_format a reply of another length. `place`: the serial.
[[nodiscard]] hal::Result<void> check_echo(const Configuration& wanted, std::span<const std::byte> echo,
                                           std::string_view place);

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
