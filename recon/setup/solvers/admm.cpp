#include "recon/core/solvers/admm.hpp"

#include <cmath>

#include "recon/setup/inverse_tables.hpp"
#include "recon/setup/solver_row_of.hpp"
#include "recon/setup/thin_step_tables.hpp"

namespace compueye::recon {
namespace {

// Fitted on 300 scenes of few dots seen by the 8x8 eye at 20 to 40 dB, drawn and measured rows.
constexpr double first_of_dip = 4.0 / 3.0;
constexpr double bottom_of_dip = 1.0 / 3.0;
constexpr int levels_down = 8, levels_at_bottom = 5, levels_up = 10, iterations_of_dip_level = 2;

/// In pixels, on a small eye: down from 4/3 rho to 1/3 within 16 iterations, and slowly back. The first iterations find
/// the lit pixels with small steps, the middle ones set their brightness with large ones: 22 to 24 iterations where the
/// best constant penalty takes 77 (64/256, 30 dB).
PenaltyLevels dip(const Objective& objective, const Plan& plan, int, bool) {
  if (objective.basis != BasisKind::identity || plan.l1_reweighting > 0.0) return {{plan.rho}, 1};
  PenaltyLevels levels;
  const double bottom = bottom_of_dip * plan.rho;
  levels.penalties.push_back(first_of_dip * plan.rho);
  push_geometric(levels.penalties.front(), bottom, levels_down - 1, levels.penalties);
  levels.penalties.insert(levels.penalties.end(), levels_at_bottom, bottom);
  push_geometric(bottom, plan.rho, levels_up, levels.penalties);
  levels.penalties.back() = plan.rho;
  levels.iterations_a_level = iterations_of_dip_level;
  return levels;
}

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    const ParityClasses classes = classes_of(from);
    auto problem = TRY(begin_factored<core::AdmmProblem<T>>(from, classes));
    problem->relaxation = static_cast<T>(from.plan.relaxation);
    problem->l1_reweighting = static_cast<T>(std::ldexp(from.plan.l1_reweighting, from.unit.picture));
    if (from.objective.basis == BasisKind::identity) {
      const PenaltyLevels levels =
          penalty_levels(from.objective, from.plan, from.rho_by_rule, classes.rows(), classes.count() > 1);
      problem->schedule = schedule_of<T>(levels, from.kept);
      problem->thin_step = from.kept.keep_view(thin_step_tables<T>(from.seeing, classes, levels.penalties));
    }
    return problem;
  }
};

}  // namespace

extern const SolverRow admm;  // for recon/solver_list.cpp
constinit const SolverRow admm = solver_row_of<core::AdmmProblem, Method>({.factor = FactorUse::inverse,
                                                                           .rho = RhoUse::penalty,
                                                                           .relaxes = true,
                                                                           .reweights = true,
                                                                           .takes = any_pair,
                                                                           .penalties = dip});

}  // namespace compueye::recon
