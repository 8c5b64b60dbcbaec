#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/eye/board.hpp"
#include "firmware/pipeline/correction.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {

/// The simulated eye of a board, unpaced: set frame_rate_hz for a live one. Dead channels are invalid from the first
/// frame on.
[[nodiscard]] sim::SimulatedEyeSettings simulated_eye_settings(const Board& board, sim::Scene scene,
                                                               std::uint64_t seed);

/// How the codes of a board become samples. `sees` as in CorrectionSettings.
[[nodiscard]] CorrectionSettings correction_settings(const Board& board, std::span<const std::uint8_t> sees = {});

/// The same board with narrow eyes: acceptance angle = interommatidial angle, every channel alive. Nothing for a
/// lattice without an interommatidial angle.
[[nodiscard]] std::optional<Board> conventional_board(const Board& board);

}  // namespace compueye::firmware
