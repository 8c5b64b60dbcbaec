#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "hal/try.hpp"
#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frozen_frame.hpp"
#include "recon/problem/plan.hpp"
#include "recon/setup/factor.hpp"
#include "recon/setup/kept_tables.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/unit_choice.hpp"

namespace compueye::recon {

/// What a method's problem is made from, and where its tables are kept.
template <class T>
struct SetUp {
  const Response& seeing;      ///< rows that see, as the operator holds them
  const Objective& objective;  ///< A's unit is that of `seeing`, x as it is asked for
  UnitChoice unit;             ///< that the frames are solved in
  Plan& plan;                  ///< every rule resolved; what only the set-up can tell (tsvd's rank) is filled in
  bool rho_by_rule;
  const std::int32_t* seeing_channels;  ///< seeing.rows() of them
  int channels;                         ///< M
  Factor& factor;                       ///< as wanted_factor() says; values to be filled in
  std::optional<Factor> stored;         ///< fits plan and rows, but may be of other classes
  const Progress& progress;
  core::Crew crew;
  KeptTables& kept;
};

/// Fills in what all methods share. Errors: those of choose_operator().
template <class T>
[[nodiscard]] hal::Result<void> fill_shared(const SetUp<T>& from, core::FrameProblem<T>& problem);

/// A method's problem with what all methods share.
template <class Problem, class T>
[[nodiscard]] hal::Result<std::shared_ptr<Problem>> begin_problem(const SetUp<T>& from) {
  auto problem = std::make_shared<Problem>();
  TRY(fill_shared<T>(from, *problem));
  return problem;
}

/// The stored factor was made for another problem. Error stale.
[[nodiscard]] hal::Result<void> stale(const Factor& stored, const Plan& plan, int seeing);
/// It was said to be this problem's, and is not. Error stale.
[[nodiscard]] hal::Result<void> not_a_factor();

/// A schedule of these penalties.
template <class T>
[[nodiscard]] core::PenaltySchedule<T> schedule_of(const PenaltyLevels& levels, KeptTables& kept);

/// What a method keeps from set-up to set-up.
enum class FactorUse : std::uint8_t {
  none,
  inverse,  ///< (A K0^-1 A' + rho I)^-1
  modes     ///< the leading modes of A A'
};

/// What Plan::rho is to a method.
enum class RhoUse : std::uint8_t {
  none,
  penalty,       ///< of the augmented Lagrangian
  inverse_step,  ///< 1 / tau of a primal step
  lambda         ///< it must be lambda
};

/// What Plan::rank is to a method.
enum class RankUse : std::uint8_t { none, singular_values, modes };

/// By what the noise says how large lambda is (recon/lambda_rule.hpp).
enum class LambdaUse : std::uint8_t {
  penalty,   ///< the weight of the l1 term
  atoms,     ///< where correlations with atoms stop being signal
  variances  ///< ratio of noise and signal
};

template <class T>
struct SolverIn {
  const core::Solver<T>* frame = nullptr;
  hal::Result<std::shared_ptr<core::FrameProblem<T>>> (*prepare)(SetUp<T>& from) = nullptr;
};

/// A method of recon/core/solvers, as everything but the frame path sees it: made by its file in recon/setup/solvers.
struct SolverRow {
  std::string_view name = {};  ///< its word on boards and command lines
  FactorUse factor = FactorUse::none;
  RhoUse rho = RhoUse::none;
  RankUse rank = RankUse::none;
  LambdaUse lambda = LambdaUse::penalty;
  bool minimises =
      true;  ///< the objective of recon/problem/plan.hpp, so that its value can be compared with that of others
  bool takes_epsilon = false;
  bool relaxes = false;            ///< Plan::relaxation
  bool reweights = false;          ///< Plan::l1_reweighting, in pixels
  bool direct = false;             ///< no iterations
  SolverKind published = nullptr;  ///< the method as its authors published it, where it is kept to be shown beside this

  /// The pairs that it takes. A solver that has one proximal map for the l1 term and the constraint together can only
  /// take pairs whose joint map is known; composing two maps looks right and is not the map of their sum.
  bool (*takes)(BasisKind basis, ConstraintKind constraint) noexcept = nullptr;
  /// What it asks of values beyond their ranges; null: nothing.
  hal::Result<void> (*check)(const Objective& objective, const Plan& plan) = nullptr;
  /// rho by rule where it is not that of penalty_rule.hpp; null: it is.
  double (*rho_by_rule)(const Response& response, const Objective& objective, const Plan& plan) = nullptr;
  /// The rank by rule of `order` modes, where the factor has one.
  int (*rank_by_rule)(const Plan& plan, int order) noexcept = nullptr;
  /// The penalties that a frame goes through where rho is by rule; null: rho alone.
  PenaltyLevels (*penalties)(const Objective& objective, const Plan& plan, int order, bool mirror_symmetric) = nullptr;

  SolverIn<float> f32 = {};
  SolverIn<double> f64 = {};
  std::vector<std::byte> (*freeze)(const core::FrameProblem<float>& problem, core::FrozenSamples samples) = nullptr;

  template <class T>
  [[nodiscard]] const SolverIn<T>& in() const noexcept {
    if constexpr (std::is_same_v<T, float>) {
      return f32;
    } else {
      return f64;
    }
  }
  /// Whether frames may go on from the last one.
  [[nodiscard]] bool starts_warm() const noexcept { return f32.frame->forget != nullptr; }
};

/// What takes any basis with any constraint, and what has one proximal map for both.
[[nodiscard]] constexpr bool any_pair(BasisKind, ConstraintKind) noexcept {
  return true;
}
[[nodiscard]] constexpr bool one_proximal_map(BasisKind basis, ConstraintKind constraint) noexcept {
  return basis == BasisKind::identity || (basis != BasisKind::tv && constraint == ConstraintKind::none);
}
[[nodiscard]] constexpr bool pixels_without_constraint(BasisKind basis, ConstraintKind constraint) noexcept {
  return basis == BasisKind::identity && constraint == ConstraintKind::none;
}

/// Whether a solver works with a cached factor at all.
[[nodiscard]] inline bool uses_factor(SolverKind solver) noexcept {
  return solver->factor != FactorUse::none;
}

/// The metric of the factor that a solver keeps: modes are always those of A A'.
[[nodiscard]] inline MetricKind metric_of(SolverKind solver, BasisKind basis) noexcept {
  return solver->factor == FactorUse::modes ? MetricKind::identity : metric_of(basis);
}

}  // namespace compueye::recon
