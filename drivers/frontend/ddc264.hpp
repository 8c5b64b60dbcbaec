#pragma once

#include <memory>

#include "drivers/frontend/front_end.hpp"

namespace compueye::frontend {

class ChipEmulator;

/// Texas Instruments SBAS368C, a daisy chain of them. Codes are as the chip says them: 4096, 0.4 % of full scale, is no
/// light. Its data carry no marker and no checksum, so a turned bit is not told, a clock too many never, and one too
/// few only where the last bit of the chain's data is 1, which then stands in the byte behind them that has to be zero
/// (DIN of the last chip is tied low). A chip that started anew sends 16 bits an input, so that the chain's last 32
/// bytes are zeros: which chip it was cannot be seen, and none of the chain is valid. When the power goes within a
/// frame, what is left of it is zeros, told in that frame where that are 32 bytes of data or more and otherwise in the
/// next one.
extern const FrontEndRow ddc264;

[[nodiscard]] std::unique_ptr<ChipEmulator> emulate_ddc264();

}  // namespace compueye::frontend
