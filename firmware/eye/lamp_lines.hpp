#pragma once

#include <memory>

#include "firmware/eye/board.hpp"
#include "hal/signal_lines.hpp"

namespace compueye::firmware {

/// The lines of a board's lamps, not opened, whose driver can hold nobody up; null: it has none.
[[nodiscard]] std::unique_ptr<hal::OutputLines> lamp_lines(const LampSettings& lamps);

}  // namespace compueye::firmware
