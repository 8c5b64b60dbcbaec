#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "hal/result.hpp"
#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"
#include "recon/response.hpp"
#include "recon/setup/factor.hpp"

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
};

/// How it is solved, decided before the first frame.
struct Plan {
  SolverKind solver = SolverKind::admm;
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
  /// How A is applied; nothing: the quickest form that keeps every digit of the precision
  /// (recon/setup/operator_choice.hpp). running_sums stands for any number of rows at once. Dense runs in bf16 or int8
  /// have to be asked for: the problem that is then solved, factor and modes included, is that of the rounded matrix
  /// (recon/setup/quantised_response.hpp).
  std::optional<OperatorKind> op = std::nullopt;
  /// That share a frame's work, the caller's among them: 1 .. WorkerThreads::most, no more than there are cores to
  /// spare. Same bits for any number. Pictures of fewer than 9,216 pixels are left to one.
  int threads = 1;
  /// tsvd: how many singular pairs to keep; 0 = those with s^2 >= lambda, which is where tikhonov's filter is a half.
  /// pdhg: how many modes to treat exactly; 0 = by rule (recon/setup/deflation_rule.hpp).
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

/// A problem that is set up: operator tables, basis tables and factor. Immutable after create(); solve() may run from
/// several threads at once, each with its own workspace, and neither allocates, locks nor throws; with Plan::threads it
/// waits for its workers.
class Reconstructor {
 public:
  /// The response must know its picture (Response::with_image()). `factor` may hand in a stored one: it is
  /// refused (error stale) when its rho or order does not fit. Errors: usage, mismatch, interrupted, and out_of_range:
  /// a setting beyond its range; a response that sees nothing or whose columns have a norm outside 1e-12..1e12 (root
  /// mean square), because float32 could not hold its factor; a rho too small or too large for the precision.
  /// unsupported: an operator that the response does not fit.
  [[nodiscard]] static hal::Result<Reconstructor> create(const Response& response, const Objective& objective,
                                                         const Plan& plan, std::optional<Factor> factor = std::nullopt,
                                                         const Progress& progress = {});

  Reconstructor(const Reconstructor&) = delete;
  Reconstructor& operator=(const Reconstructor&) = delete;
  Reconstructor(Reconstructor&&) noexcept;
  Reconstructor& operator=(Reconstructor&&) noexcept;
  ~Reconstructor();

  [[nodiscard]] int channels() const noexcept;  ///< M, blind rows included
  [[nodiscard]] int image_rows() const noexcept;
  [[nodiscard]] int image_cols() const noexcept;
  [[nodiscard]] int pixels() const noexcept;  ///< N
  [[nodiscard]] int seeing_channels() const noexcept;
  [[nodiscard]] const Objective& objective() const noexcept;
  [[nodiscard]] const Plan& plan() const noexcept;  ///< with every rule resolved (rho, rank, max_reweighted)
  [[nodiscard]] OperatingPoint operating_point() const noexcept;

  /// Another number of iterations a frame, not while a solve() runs. Changes nothing of a direct solver's frames.
  /// Error: out_of_range.
  [[nodiscard]] hal::Result<void> set_iterations(int iterations);

  /// Exact size of the workspace that solve() wants, for 64-byte aligned memory.
  [[nodiscard]] std::size_t required_bytes() const noexcept;
  /// Bytes of the tables behind it: operator, basis and factor.
  [[nodiscard]] std::size_t table_bytes() const noexcept;

  /// One frame: y and weights have M entries (weights empty: all one; each 0..1, 0 = channel missing, its y may then
  /// be anything), x has N. `workspace` is at least required_bytes() and 64-byte aligned. Same input, same bits.
  /// A frame that cannot be solved has Health::invalid, which says why that may be, and x is zero. What blind channels
  /// read and weigh is never looked at.
  [[nodiscard]] FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                                std::span<std::byte> workspace, std::span<float> x) const noexcept;

  /// What the factor of such a plan is, without its values: what a stored one has to be to be used.
  [[nodiscard]] static Factor wanted_factor(const Response& response, const Objective& objective, const Plan& plan);

  /// The next frame in this workspace starts cold, whatever the plan says. `workspace` as for solve().
  void forget_last_frame(std::span<std::byte> workspace) const noexcept;

  /// Gives back the memory of modes that were only kept to be stored: factor() has no values afterwards. Not while a
  /// solve() runs; does nothing to an inverse, which every frame needs.
  void forget_modes() noexcept;

  /// The factor, to be stored; without values where the plan needs none.
  [[nodiscard]] const Factor& factor() const noexcept;

  /// What solve() works with, valid as long as this lives; null in double.
  [[nodiscard]] const core::FrameProblem<float>* frame_problem() const noexcept;

 private:
  struct Tables;
  static hal::Result<Reconstructor> create_as_applied(const Response& response, const Objective& objective,
                                                      const Plan& plan, std::optional<Factor> factor,
                                                      const Progress& progress);
  explicit Reconstructor(std::unique_ptr<Tables> tables) noexcept;
  std::unique_ptr<Tables> tables_;
};

}  // namespace compueye::recon
