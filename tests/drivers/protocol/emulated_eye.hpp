#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

#include "drivers/protocol/emulated_transport.hpp"
#include "tests/drivers/protocol/small_host.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

namespace compueye::protocol::tests {

inline EmulatorSettings eye_settings(const Bus* bus, int channels = 64, std::uint64_t seed = 1) {
  EmulatorSettings settings;
  settings.bus = bus;
  settings.descriptor = descriptor_of(channels, 12, seed);
  settings.seed = seed;
  return settings;
}

/// A small host with an emulated eye of its own, in virtual time.
class EmulatedEye : public SmallHost {
 public:
  explicit EmulatedEye(const EmulatorSettings& settings)
      : SmallHost(transport, clock, settings.bus, settings.descriptor),
        device(DeviceEmulator::create(settings, shown(bits)).value()),
        transport(device, clock) {}

  void inject(EmulatorFault fault) {
    if (!fault.at_frame) fault.at_ns = clock.now_ns();
    device.inject(std::move(fault));
  }

  hal::VirtualClock clock{10 * second};
  DeviceEmulator device;
  EmulatedTransport transport;
};

}  // namespace compueye::protocol::tests
