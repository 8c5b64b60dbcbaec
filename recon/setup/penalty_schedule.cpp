#include "recon/setup/penalty_schedule.hpp"

#include <algorithm>
#include <cmath>

#include "recon/setup/deflation_rule.hpp"

namespace compueye::recon {
namespace {

// Fitted on 300 scenes of few dots seen by the 8x8 eye at 20 to 40 dB, drawn and measured rows.
constexpr double first_of_dip = 4.0 / 3.0;
constexpr double bottom_of_dip = 1.0 / 3.0;
constexpr int levels_down = 8, levels_at_bottom = 5, levels_up = 10, iterations_of_dip_level = 2;

// Fitted on line art seen by the 80x80 and the 120x120 eye at sigma .1 to 10.
constexpr double most_rise = 2.0;
constexpr double factor_by_lambda = 0.6;
constexpr int levels_of_rise = 5, iterations_of_rise_level = 4;

// Fitted on line art and rows of the 80x80 eye as a calibration might find them.
constexpr double top_of_fall = 2.5, end_of_fall = 4.0 / 7.0;
constexpr int levels_of_fall = 6, iterations_of_fall_level = 2;

/// Appends `count` values after `from` that end with `to`, each the same factor from the one before.
void push_geometric(double from, double to, int count, std::vector<double>& values) {
  for (int k = 1; k <= count; ++k) values.push_back(from * std::pow(to / from, static_cast<double>(k) / count));
}

PenaltyLevels dip(double rho) {
  PenaltyLevels levels;
  const double bottom = bottom_of_dip * rho;
  levels.penalties.push_back(first_of_dip * rho);
  push_geometric(levels.penalties.front(), bottom, levels_down - 1, levels.penalties);
  levels.penalties.insert(levels.penalties.end(), levels_at_bottom, bottom);
  push_geometric(bottom, rho, levels_up, levels.penalties);
  levels.penalties.back() = rho;
  levels.iterations_a_level = iterations_of_dip_level;
  return levels;
}

/// By how much rho may be exceeded: a frame with a large lambda is over within a few iterations, and gains nothing.
double most_factor(double most, double rho, double lambda) {
  return most * lambda < factor_by_lambda * rho ? most : factor_by_lambda * rho / lambda;
}

PenaltyLevels rise(double rho, double lambda) {
  const double factor = most_factor(most_rise, rho, lambda);
  if (factor <= 1.0) return {{rho}, 1};
  PenaltyLevels levels{{rho}, iterations_of_rise_level};
  push_geometric(rho, factor * rho, levels_of_rise - 1, levels.penalties);
  return levels;
}

PenaltyLevels fall(double rho, double lambda) {
  const double factor = most_factor(top_of_fall, rho, lambda);
  if (factor <= 1.0) return {{rho}, 1};
  PenaltyLevels levels{{factor * rho}, iterations_of_fall_level};
  push_geometric(factor * rho, std::max(1.0, factor * end_of_fall) * rho, levels_of_fall - 1, levels.penalties);
  return levels;
}

}  // namespace

PenaltyLevels penalty_levels(const Objective& objective, const Plan& plan, bool rho_by_rule, int order,
                             bool mirror_symmetric) {
  const bool in_pixels = objective.basis == BasisKind::identity;
  if (rho_by_rule && plan.solver == SolverKind::admm && in_pixels && plan.l1_reweighting == 0.0) return dip(plan.rho);
  if (rho_by_rule && plan.solver == SolverKind::pdhg && !in_pixels && objective.basis != BasisKind::tv &&
      resolve_rank(plan, order) < order) {
    return mirror_symmetric ? rise(plan.rho, objective.lambda) : fall(plan.rho, objective.lambda);
  }
  return {{plan.rho}, 1};
}

}  // namespace compueye::recon
