#pragma once

#include <cstdint>

#include "firmware/eye/board.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "sim/scene.hpp"

namespace compueye::firmware {

/// Rows that see less than this share of one pixel are left out of the conventional picture: what they read, divided by
/// so little, is noise.
inline constexpr double least_conventional_row_sum = 0.1;

/// What the conventional compound eye beside this one shows of the scene: the same lattice, sensor and noise, but with
/// an acceptance angle as narrow as the interommatidial angle, every ommatidium alive, and its samples shown as they
/// are (recon/conventional_image.hpp). One frame, number 0 of `seed`. Errors: unsupported (a lattice without an
/// interommatidial angle), and those of the nominal response and the simulated eye.
[[nodiscard]] hal::Result<hal::Image> conventional_picture(const Board& board, const sim::Scene& scene,
                                                           std::uint64_t seed);

}  // namespace compueye::firmware
