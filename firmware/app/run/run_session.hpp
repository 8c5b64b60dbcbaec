#pragma once

#include "firmware/app/run/run_options.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// `compueye run`: makes the board ready, runs the pipeline on it and reports. Errors end the program with one
/// sentence; with --json the same is an object on stdout. A run that fails after its first frame is reported before.
[[nodiscard]] hal::Result<void> run_session(const RunOptions& options);

}  // namespace compueye::firmware
