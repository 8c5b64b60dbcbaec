#pragma once

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What no single key can tell: keys that need or exclude each other, sizes that are only absurd together, and hal's
/// own rules. Errors (bad_format, mismatch, out_of_range) carry the line of the key concerned.
[[nodiscard]] hal::Result<void> check_consistency(const Board& board);

}  // namespace compueye::firmware
