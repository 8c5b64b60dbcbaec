#pragma once

#include <memory>

#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "recon/problem/progress.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {

/// A simulated eye whose effects are planned by how much a reconstruction of this board bears. That takes its set-up
/// and some thirty frames, and is measured only where a plan depends on it: as long as nothing is called for but what
/// is plainly too large to be left out, the figures of the paper's small eye serve. Errors: those of
/// SimulatedEye::create() and ReadyEye::make(); interrupted.
[[nodiscard]] hal::Result<std::unique_ptr<sim::SimulatedEye>> planned_eye(const Board& board,
                                                                          sim::SimulatedEyeSettings settings,
                                                                          hal::Clock& clock,
                                                                          const recon::Progress& progress);

}  // namespace compueye::firmware
