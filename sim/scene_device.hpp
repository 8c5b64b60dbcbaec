#pragma once

#include <memory>

#include "drivers/protocol/device_emulator.hpp"
#include "sim/simulation.hpp"

namespace compueye::sim {

/// What a device made by the emulator of the protocol sees: the frames of `simulation`, number by number the same codes
/// that SimulatedEye delivers, so that an eye on an emulated cable and a simulated one are one and the same. The
/// device's channels are its ommatidia in order. Codes are cut off at the depth of `descriptor`'s codes.
[[nodiscard]] protocol::SampleGenerator samples_of(std::shared_ptr<Simulation> simulation);

/// The descriptor of a device that is this board: channels, depth and mapping.
[[nodiscard]] protocol::DeviceDescriptor describe_device(const EyeToSimulate& board, const std::string& serial);

}  // namespace compueye::sim
