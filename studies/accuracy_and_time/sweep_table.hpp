#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"
#include "studies/accuracy_and_time/motion.hpp"
#include "studies/accuracy_and_time/pareto_options.hpp"

namespace compueye::firmware {

/// One curve of accuracy against time: everything that stays while the iterations grow.
struct Curve {
  recon::SolverKind solver = recon::SolverKind::admm;
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
  recon::Precision precision = recon::Precision::f32;
  std::optional<recon::OperatorKind> op = std::nullopt;  ///< absent: the quickest form of A
  Motion motion = Motion::none;  ///< of the frames that a warm start goes on from; none: every frame starts cold
  int threads = 1;

  bool operator==(const Curve&) const = default;
};

/// "admm dct", "admm dct f64", "pdhg dct, dense runs in int8", "pdhg dct, warm, still", "pdhg dct, 2 threads":
/// what a legend says.
[[nodiscard]] std::string title(const Curve& curve);

/// A curve and how far it is followed.
struct PlannedCurve {
  Curve curve;
  std::vector<int> iterations;  ///< ascending
};

struct SweepPlan {
  std::vector<PlannedCurve> curves;  ///< what matters most first, because time may run out
  std::vector<std::string> notes;    ///< what was left out, and how to ask for it
};

/// The table of what is swept, cut to the options and to an eye of `seeing` rows: with the board's constraint where a
/// pair takes it, else with none; the board's own point is always among its solver's. Error usage for a name that does
/// not exist, or when nothing is left.
[[nodiscard]] hal::Result<SweepPlan> plan_sweep(const Board& board, const ParetoOptions& options, int seeing);

}  // namespace compueye::firmware
