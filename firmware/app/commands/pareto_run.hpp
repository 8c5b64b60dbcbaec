#pragma once

#include <filesystem>

#include "hal/result.hpp"
#include "studies/accuracy_and_time/sweep_plan.hpp"

namespace compueye::firmware {

/// What `compueye pareto` was asked for.
struct ParetoRequest : SweepOptions {
  std::filesystem::path board;
  std::filesystem::path out;  ///< folder for CSV and plots; empty: none
  bool json = false;

  /// Error usage, naming option and value. Names of solvers, bases and scenes are checked where they are looked up.
  [[nodiscard]] hal::Result<void> check() const;
};

/// `compueye pareto`: accuracy against time of everything that a board can be solved with, on this machine. Prints the
/// efficient points, stores every point beside the board for `run --deadline`, and writes CSV and plots. Ctrl-C keeps
/// what was measured, and the stored points say that they are partial.
[[nodiscard]] hal::Result<void> run_pareto(const ParetoRequest& request);

}  // namespace compueye::firmware
