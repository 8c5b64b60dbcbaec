#pragma once

#include "firmware/app/run/run_options.hpp"
#include "firmware/app/session.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// `compueye run`: makes the board ready, runs the pipeline on it and reports. A run that fails after its first frame
/// is reported before.
[[nodiscard]] hal::Result<void> run_board(const RunOptions& options, Session& session);

}  // namespace compueye::firmware
