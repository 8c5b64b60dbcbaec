#pragma once

#include <cstdint>
#include <optional>

#include "recon/core/frame/frame_info.hpp"

namespace compueye::recon {

enum class ConstraintKind : std::uint8_t { none, nonnegative, box };

/// min over x of 1/2 ||W^(1/2)(Ax-y)||^2 + lambda ||Psi x||_1 subject to the constraint (tikhonov: + lambda/2 ||x||^2
/// instead of the l1 term; omp and tsvd: no term, lambda is where they stop). With an epsilon, for adm and omp:
/// min ||Psi x||_1 (omp: the number of non-zeros of Psi x) subject to ||W^(1/2)(Ax-y)|| <= epsilon and the constraint;
/// lambda then plays no part. Intensities are in units of display white.
struct Objective {
  BasisKind basis = BasisKind::identity;  ///< Psi, see core/basis.hpp
  ConstraintKind constraint = ConstraintKind::none;
  double lo = 0.0;  ///< box only; lo < hi
  double hi = 1.0;
  double lambda = 0.0;                           ///< >= 0
  std::optional<double> epsilon = std::nullopt;  ///< >= 0, in units of y
  /// > 0, in units of y: residuals beyond it count by their size and not by their square, so that samples far off,
  /// which no mask has caught, do not decide the picture (recon/huber_passes.hpp). A frame then is solved up to eight
  /// times.
  std::optional<double> huber = std::nullopt;
};

/// admm, the first row of recon/solver_list.hpp.
[[nodiscard]] SolverKind default_solver() noexcept;

/// How it is solved, decided before the first frame.
struct Plan {
  SolverKind solver = default_solver();
  /// Of the frame path. Relative errors grow with the condition number of A A' + rho I times 6e-8 (f32) or 1e-16 (f64).
  Precision precision = Precision::f32;
  int iterations = 100;     ///< exactly this many per frame, 1 .. 1e6; at most, for omp and adm as published
  double rho = 0.0;         ///< ADMM penalty, or pdhg's inverse primal step; 0 = by rule (recon/setup/penalty_rule.hpp)
  double relaxation = 1.7;  ///< of admm, cp and pdhg, 0 < relaxation < 2
  /// admm with the identity: e > 0 follows the K iterations by K more for min 1/2 ||Ax-y||^2 + lambda sum_j w_j |x_j|,
  /// w_j = 2 e / (|x_j| + e) with x of the first pass (Candes, Wakin & Boyd 2008, "Enhancing sparsity by reweighted l1
  /// minimization"). For pictures of few lit pixels, e a tenth of their brightness; docs/lambda-rule.md says when it
  /// pays. FrameInfo's objective is the weighted one, without a duality gap. 0: one pass.
  double l1_reweighting = 0.0;
  /// How A is applied; nothing: wavelet runs for large measured eyes that they fit (recon/setup/rounded_form.hpp), else
  /// the quickest form that keeps every digit of the precision (recon/setup/operator_list.hpp). running_sums stands for
  /// any number of rows at once. Dense runs in bf16 or int8 have to be asked for. In a form that rounds, the problem
  /// that is solved, factor and modes included, is that of the rounded matrix (recon/setup/quantised_response.hpp).
  std::optional<OperatorKind> op = std::nullopt;
  /// That share a frame's work, the caller's among them: 1 .. WorkerThreads::most, no more than there are cores to
  /// spare. Same bits for any number. Pictures of fewer than 9,216 pixels are left to one.
  int threads = 1;
  /// tsvd: how many singular pairs to keep; 0 = those with s^2 >= lambda, which is where tikhonov's filter is a half.
  /// pdhg: how many modes to treat exactly; 0 = by rule (recon/setup/solvers/pdhg.cpp).
  int rank = 0;
  /// Seeing channels that may have a weight other than one in a frame; -1 = a tenth of them, rounded up. Costs
  /// max_reweighted * (M + max_reweighted) numbers of workspace.
  int max_reweighted = -1;
  /// pdhg: a frame goes on from the last one that was solved in the same workspace, unless its samples have changed too
  /// much (core/warm_start.hpp); FrameInfo::warm says which. The same frames in the same order give the same bits.
  bool warm_start = false;
  /// Fills in FrameInfo::duality_gap, which costs about one iteration a frame.
  bool measure_gap = false;
};

}  // namespace compueye::recon
