#pragma once

#include <cstdint>
#include <string>

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"
#include "recon/problem/progress.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::firmware {

/// What is shown of a scene: one frame before one board.
struct GalleryRequest {
  std::string png;          ///< the sheet
  std::uint64_t frame = 0;  ///< the last one of those that are simulated
  std::uint64_t seed = 0;   ///< of the noise
};

/// A sheet with a row for every effect that the scene or the board calls for, in the order of light: the frame without
/// it, as the eye's grid, and what it changes, in LSB, all others being on. Errors: those of Simulation::create() and
/// write_contact_sheet(); not_found (nothing calls for any effect); interrupted.
[[nodiscard]] hal::Result<void> write_effect_gallery(const Board& board, const sim::Scene& scene,
                                                     const GalleryRequest& request, const recon::Progress& progress);

}  // namespace compueye::firmware
