#pragma once

#include "hal/result.hpp"
#include "studies/accuracy_and_time/pareto_options.hpp"

namespace compueye::firmware {

/// `compueye pareto`: accuracy against time of everything that a board can be solved with, on this machine. Prints the
/// efficient points, stores every point beside the board for `run --deadline`, and writes CSV and plots. Ctrl-C keeps
/// what was measured, and the stored points say that they are partial.
[[nodiscard]] hal::Result<void> pareto(const ParetoOptions& options);

}  // namespace compueye::firmware
