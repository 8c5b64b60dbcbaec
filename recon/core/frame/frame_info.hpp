#pragma once

#include <cstdint>

#include "recon/core/bases/basis.hpp"
#include "recon/core/operators/linear_operator.hpp"

namespace compueye::recon {

/// A solver, by its row (recon/setup/solver_row.hpp); the frame path only passes it on.
struct SolverRow;
using SolverKind = const SolverRow*;
enum class Precision : std::uint8_t { f32, f64 };

/// One way of turning y into x, with a known cost.
struct OperatingPoint {
  OperatorKind op = OperatorKind::csr;
  BasisKind basis = BasisKind::identity;
  SolverKind solver = nullptr;
  Precision precision = Precision::f32;
  int iterations = 0;
};

enum class Health : std::uint8_t {
  converged,    ///< the duality gap is below 1e-3 of the objective; where the problem has no gap, the last step was
                ///< below 1e-6 (adm, admm: both residuals below 1e-3)
  budget_used,  ///< exactly K iterations done, and a larger gap or none measured: normal in real time
  invalid,      ///< NaN or infinity in y or in the result, a weight outside 0..1, more reweighted channels than planned
                ///< or buffers of the wrong size: x is all zero, and so are objective and residuals
};

/// What a solver says about one frame. Not an error type: using up the budget is normal. Sums run over seeing channels;
/// what blind ones read is a constant that no x changes.
struct FrameInfo {
  OperatingPoint point;
  Health health = Health::invalid;
  int iterations = 0;
  bool warm = false;             ///< it went on from the last frame (Plan::warm_start)
  int channels_used = 0;         ///< seeing rows with a weight above zero
  int channels_reweighted = 0;   ///< seeing rows with a weight other than one in this frame
  double objective = 0.0;        ///< 1/2 ||W^(1/2)(Ax-y)||^2 + lambda ||Psi x||_1 (tikhonov: + lambda/2 ||x||^2)
  double residual = 0.0;         ///< ||W^(1/2)(Ax-y)||, in units of y
  double primal_residual = 0.0;  ///< ||x - z|| / ||x||, z being what is handed out; 0 for direct solvers
  double dual_residual = 0.0;    ///< ||z - z before|| / ||u||, u the scaled dual variables; 0 for direct solvers
  /// Objective minus a dual objective, so at least as much as the objective lies above the optimum. In float32 it ends
  /// at about 5e-4 of the objective where the residual is a hundredth of y. Negative: not asked for
  /// (Plan::measure_gap), or the solver or the problem has none.
  double duality_gap = -1.0;
};

}  // namespace compueye::recon
