#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/operating_points/measured_points.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What is swept, how far, and in front of what.
struct SweepOptions {
  bool quick = false;
  std::optional<double> budget_s;             ///< 0 = no end; absent: ten minutes, with `quick` half a minute
  double longest_ms = 1000.0;                 ///< slower frames are not tried, > 0
  std::vector<std::string> solvers;           ///< empty: all
  std::vector<std::string> bases;             ///< empty: all
  std::vector<std::string> scenes;            ///< built-in ones; empty: those that suit the picture's size
  std::vector<double> noise{1.0, 4.0, 16.0};  ///< times the board's own, each > 0, at least one

  [[nodiscard]] double seconds() const noexcept;  ///< of the budget; infinity without an end
};

/// A curve and how far it is followed.
struct PlannedCurve {
  Curve curve;
  std::vector<int> iterations;  ///< ascending
};

struct SweepPlan {
  std::vector<PlannedCurve> curves;  ///< what matters most first, because time may run out
  std::vector<std::string> notes;    ///< what was left out, and how to ask for it
};

/// What is swept of recon's solvers, bases and operators, cut to the options and to an eye of `seeing` rows: with the
/// board's constraint where a pair takes it, else with none; the board's own point is always among its solver's. Error
/// usage for a name that does not exist, or when nothing is left.
[[nodiscard]] hal::Result<SweepPlan> plan_sweep(const Board& board, const SweepOptions& options, int seeing);

}  // namespace compueye::firmware
