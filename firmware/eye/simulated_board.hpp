#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/eye/board.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/pipeline/correction.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "sim/scene/scene.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {

/// What a simulation needs to know of a board.
[[nodiscard]] sim::EyeToSimulate eye_to_simulate(const Board& board);

/// The simulated eye of a board, unpaced: set frame_rate_hz for a live one. Dead channels are invalid from the first
/// frame on.
[[nodiscard]] sim::SimulatedEyeSettings simulated_eye_settings(const Board& board, sim::Scene scene,
                                                               std::uint64_t seed);

/// How the codes of a board become samples, by what was `measured` of its eye where that is not null. `sees` as in
/// CorrectionSettings.
[[nodiscard]] CorrectionSettings correction_settings(const Board& board, std::span<const std::uint8_t> sees = {},
                                                     const MeasuredEye* measured = nullptr);

/// The same board with narrow eyes: acceptance angle = interommatidial angle, every channel alive. Nothing for a
/// lattice without an interommatidial angle.
[[nodiscard]] std::optional<Board> conventional_board(const Board& board);

/// Rows that see less than this share of one pixel are left out of the conventional picture: what they read, divided by
/// so little, is noise.
inline constexpr double least_conventional_row_sum = 0.1;

/// What the conventional compound eye beside this one shows of the scene: the same lattice, sensor and noise, but with
/// an acceptance angle as narrow as the interommatidial angle, every ommatidium alive, and its samples shown as they
/// are (recon/conventional_image.hpp). One frame, number 0 of `seed`. Errors: unsupported (a lattice without an
/// interommatidial angle), and those of the nominal response and the simulated eye; interrupted (by the watch).
[[nodiscard]] hal::Result<hal::Image> conventional_picture(const Board& board, const sim::Scene& scene,
                                                           std::uint64_t seed, const sim::RenderWatch& watch = {});

}  // namespace compueye::firmware
