#include "recon/core/solvers/pdhg.hpp"

#include <algorithm>

#include "recon/setup/dual_step_tables.hpp"
#include "recon/setup/factor_check.hpp"
#include "recon/setup/leading_modes.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/shorter_side.hpp"
#include "recon/setup/solver_row_of.hpp"

namespace compueye::recon {
namespace {

constexpr int least_by_rule = 400;
constexpr int rows_a_mode = 12;

/// How many of the `order` modes of A A' pdhg treats exactly: plan.rank when given, else 400 or a twelfth, at most all.
/// On the 80x80 eye (line art, DCT, sigma^2 = .1) 100, 200, 400 and 800 modes come within 5 % of the converged NMSE in
/// more than 40, 40, 18 and 13 iterations; each 400 cost a quarter of an iteration and .9 MB. On the 120x120 eye 400
/// and 800 take 50 and 29.
int rank_by_rule(const Plan& plan, int order) noexcept {
  return std::min(order, plan.rank > 0 ? plan.rank : std::max(least_by_rule, order / rows_a_mode));
}

/// w: the share of the step bound that the basis takes, the modes of A take the rest: .18, .25 where every mode is
/// known, and .4 for total variation (80x80, sigma^2 = .1: .12, .18, .25 and .35 take 27, 27, 27 and 29 iterations in
/// the DCT, and within 10 % 22, 23, 24 and 25; .15, .4 and .6 take 42, 32 and 37 in total variation). In pixels there
/// is no such dual; a hundredth is left for the rounding of the modes.
double basis_share(BasisKind basis, bool every_mode) noexcept {
  if (basis == BasisKind::identity) return 0.01;
  if (basis == BasisKind::tv) return 0.4;
  return every_mode ? 0.25 : 0.18;
}

constexpr double share_with_every_mode = 0.06, share_with_few_modes = 0.021;

/// The inverse of the primal step: .06 ||A||_F^2 / N in every basis where all modes are known, else .021, whose longer
/// steps do more for the modes that are not. On the 80x80 eye that is 7 (x >= 0, eight scenes): at sigma^2 = .1, 5, 7
/// and 10 take 42, 30 and 27 iterations to 5 % of the converged NMSE in the DCT, 50, 40 and 36 in total variation; at
/// 30 dB, 2, 2 and more than 60. The whole norm even where single rows
/// are far louder than the others, because the strongest mode bounds the steps.
double rho_by_rule(const Response& response, const Objective&, const Plan& plan) {
  const int order = mode_count(static_cast<int>(response.seeing_rows().size()), response.cols());
  const double by_rows = response.squared_norm() / response.cols();
  return (rank_by_rule(plan, order) == order ? share_with_every_mode : share_with_few_modes) * by_rows;
}

// Fitted on line art seen by the 80x80 and the 120x120 eye at sigma .1 to 10.
constexpr double most_rise = 2.0;
constexpr double factor_by_lambda = 0.6;
constexpr int levels_of_rise = 5, iterations_of_rise_level = 4;

// Fitted on line art and rows of the 80x80 eye as a calibration might find them.
constexpr double top_of_fall = 2.5, end_of_fall = 4.0 / 7.0;
constexpr int levels_of_fall = 6, iterations_of_fall_level = 2;

/// By how much rho may be exceeded: a frame with a large lambda is over within a few iterations, and gains nothing.
double most_factor(double most, double rho, double lambda) {
  return most * lambda < factor_by_lambda * rho ? most : factor_by_lambda * rho / lambda;
}

/// Up to twice rho within 16 iterations, unless lambda / rho says that the frame is over by then: 26 iterations for 30
/// at 80x80, 22 for 34 at 120x120 (paper noise).
PenaltyLevels rise(double rho, double lambda) {
  const double factor = most_factor(most_rise, rho, lambda);
  if (factor <= 1.0) return {{rho}, 1};
  PenaltyLevels levels{{rho}, iterations_of_rise_level};
  push_geometric(rho, factor * rho, levels_of_rise - 1, levels.penalties);
  return levels;
}

/// On an eye without mirror symmetry, whose rows were measured: down from 5/2 rho to 10/7 of it within 12 iterations,
/// 20 iterations for 34 at 80x80.
PenaltyLevels fall(double rho, double lambda) {
  const double factor = most_factor(top_of_fall, rho, lambda);
  if (factor <= 1.0) return {{rho}, 1};
  PenaltyLevels levels{{factor * rho}, iterations_of_fall_level};
  push_geometric(factor * rho, std::max(1.0, factor * end_of_fall) * rho, levels_of_fall - 1, levels.penalties);
  return levels;
}

/// In an orthonormal basis whose modes are not all known.
PenaltyLevels penalties(const Objective& objective, const Plan& plan, int order, bool mirror_symmetric) {
  const bool transformed = objective.basis != BasisKind::identity && objective.basis != BasisKind::tv;
  if (!transformed || rank_by_rule(plan, order) == order) return {{plan.rho}, 1};
  return mirror_symmetric ? rise(plan.rho, objective.lambda) : fall(plan.rho, objective.lambda);
}

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    auto problem = TRY(begin_problem<core::PdhgProblem<T>>(from));
    const Plan& plan = from.plan;
    const int modes = mode_count(from.seeing.rows(), from.seeing.cols());
    const double share = basis_share(from.objective.basis, plan.rank >= modes);
    problem->rho = static_cast<T>(plan.rho);
    problem->basis_step = static_cast<T>(share * plan.rho / problem->psi.squared_norm());
    problem->relaxation = static_cast<T>(plan.relaxation);
    problem->warm_start = plan.warm_start;
    const ParityClasses classes = mode_classes(from.seeing);
    TRY(find_modes(from, classes));
    const PenaltyLevels levels = penalty_levels(from.objective, plan, from.rho_by_rule, modes, classes.count() > 1);
    problem->schedule = schedule_of<T>(levels, from.kept);
    problem->dual_step =
        from.kept.keep_view(TRY(dual_step_tables<T>(classes, from.factor.values, plan.rank, levels.penalties, share)));
    problem->dual_step.crew = from.crew;
    return problem;
  }

  /// The stored ones, or new ones.
  template <class T>
  static hal::Result<void> find_modes(SetUp<T>& from, const ParityClasses& classes) {
    if (from.stored && from.stored->values.size() != modes_size(classes, from.plan.rank)) {
      return stale(*from.stored, from.plan, from.seeing.rows());
    }
    if (from.stored && from.stored->from_file && !are_modes(from.stored->values, from.plan.rank, from.seeing, classes))
      return not_a_factor();
    from.factor.values =
        from.stored ? std::move(from.stored->values) : TRY(leading_modes(from.seeing, from.plan.rank, from.progress));
    return {};
  }
};

}  // namespace

extern const SolverRow pdhg;  // for recon/solver_list.cpp
constinit const SolverRow pdhg = solver_row_of<core::PdhgProblem, Method>({.factor = FactorUse::modes,
                                                                           .rho = RhoUse::inverse_step,
                                                                           .rank = RankUse::modes,
                                                                           .relaxes = true,
                                                                           .takes = any_pair,
                                                                           .rho_by_rule = rho_by_rule,
                                                                           .rank_by_rule = rank_by_rule,
                                                                           .penalties = penalties});

}  // namespace compueye::recon
