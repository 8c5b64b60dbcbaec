#pragma once

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// That [lamps] names as many lines as the object plane has pixels, 32 at most, and that a real eye is before them.
/// Errors at the key's place: bad_format, mismatch.
[[nodiscard]] hal::Result<void> check_lamps(const Board& board);

}  // namespace compueye::firmware
