#pragma once

#include "firmware/eye/board.hpp"
#include "firmware/operating_points/measured_points.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "recon/setup/factor.hpp"
#include "studies/accuracy_and_time/sweep_plan.hpp"

namespace compueye::firmware {

/// Measures everything: pictures of every scene at every noise level, some timed frames of every point, and then many
/// of the efficient ones. A stop or the end of the budget keeps what is done. Errors: when there is no point at all.
[[nodiscard]] hal::Result<Sweep> sweep(const Board& board, const SweepOptions& options, const hal::Clock& clock,
                                       const recon::Progress& progress);

}  // namespace compueye::firmware
