#pragma once

#include <cstdint>
#include <memory>

#include "drivers/frontend/front_end.hpp"

namespace compueye::frontend {

class ChipEmulator;

/// Texas Instruments SBAS950. Its frames end with a CRC over all that comes before: a turned bit and a clock that is
/// lost or doubled are crc_error wherever they change anything. Its frame rates are those of its own clock of 8.192
/// MHz, and no others. The two conversions that it keeps (section 8.5.1.9.1) may be delivered late after a pause; the
/// emulator has no such store.
extern const FrontEndRow ads131m08;

/// `id`: of the register of that name, 28xxh for this chip.
[[nodiscard]] std::unique_ptr<ChipEmulator> emulate_ads131m08(std::uint16_t id);

}  // namespace compueye::frontend
