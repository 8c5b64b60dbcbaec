#pragma once

#include <memory>

#include "drivers/frontend/front_end.hpp"

namespace compueye::frontend {

class ChipEmulator;

/// Texas Instruments SBAS582C. Each result is followed by its channel, the device's number and the range, seven zeros
/// behind them. The device's number is set to 1, so that this tail is never all zeros: every clock that is lost or
/// doubled before its end moves it and is told. A chip that lost its settings says its results without a tail. A bit
/// that is turned among the 16 of a result is not told: the chip has no checksum.
extern const FrontEndRow ads8688;

[[nodiscard]] std::unique_ptr<ChipEmulator> emulate_ads8688();

}  // namespace compueye::frontend
