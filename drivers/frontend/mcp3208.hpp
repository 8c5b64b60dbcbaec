#pragma once

#include <memory>

#include "drivers/frontend/front_end.hpp"

namespace compueye::frontend {

class ChipEmulator;

/// Microchip DS21298E. What its bits can tell: the 11 that nothing drives read 1 through the pull-up on MISO, which the
/// board has to have, and the null bit behind them 0. A clock that is lost from the start bit to the null bit moves
/// that pattern and is told; so is one that is doubled from the start bit to the last before the null bit, the last
/// only where the code's first bit is 1. One among the 12 bits of data is not: the wire has nothing that says so. Nor
/// is a loss of power before the last byte of a conversion.
extern const FrontEndRow mcp3208;

[[nodiscard]] std::unique_ptr<ChipEmulator> emulate_mcp3208();

}  // namespace compueye::frontend
