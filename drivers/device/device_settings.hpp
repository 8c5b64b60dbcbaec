#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/device/back_off.hpp"
#include "drivers/protocol/bus.hpp"
#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::device {

/// How to run an eye.
struct DeviceSettings {
  const protocol::Bus* bus = &protocol::usb_bus;  ///< what the transport is; never null
  std::string serial;            ///< which eye; empty: the one that is there first, and then only that one
  double frame_rate_hz = 100.0;  ///< within the device's limits; rounded to 0.001
  std::int64_t exposure_ns = 0;  ///< within the device's limits, at most the frame period; 0: as long as both allow
  std::optional<protocol::SampleFormat> format;  ///< nothing: the shortest that carries the device's bits
  std::uint32_t first_config_id = 0;             ///< of the first start; 0: drawn at random. Tests set it

  /// How long there may be no frame before the stream is reset: more than a frame period; 0: five periods, but at least
  /// 50 ms.
  std::int64_t silence_ns = 0;
  /// How long read() tries to get frames again after it lost the device or its stream, in its own waiting time;
  /// 0: not at all.
  std::int64_t recovery_limit_ns = 30'000'000'000;
  /// How long create() and start() try, > 0.
  std::int64_t start_limit_ns = 2'000'000'000;
  BackOffSettings back_off;  ///< pauses between attempts
};

/// Error out_of_range names the setting, its value and its range.
[[nodiscard]] hal::Result<void> check_settings(const DeviceSettings& settings);

/// The configuration to ask this device for; config_id is 0. Errors: out_of_range (names the setting and what the
/// device can do), unsupported (a device that the bus cannot carry).
[[nodiscard]] hal::Result<protocol::Configuration> configuration_for(const DeviceSettings& settings,
                                                                     const protocol::DeviceDescriptor& device);

}  // namespace compueye::device
