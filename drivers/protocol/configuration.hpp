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

}  // namespace compueye::protocol
