#pragma once

#include <vector>

#include "recon/plan.hpp"

namespace compueye::recon {

/// What a core::PenaltySchedule is made of: the penalties that the iterations of a frame go through, around the rule's
/// rho. Frames with a weight other than one stay at rho, for which alone a cached factor is made.
struct PenaltyLevels {
  std::vector<double> penalties;
  int iterations_a_level = 1;
};

/// Those of the plan's solver (recon/setup/solvers); a rho that was asked for stays (one level). `plan` has its rho,
/// asked for or by rule, and its rank, if it has one; `order` is the number of seeing rows.
[[nodiscard]] PenaltyLevels penalty_levels(const Objective& objective, const Plan& plan, bool rho_by_rule, int order,
                                           bool mirror_symmetric);

/// Appends `count` values after `from` that end with `to`, each the same factor from the one before.
void push_geometric(double from, double to, int count, std::vector<double>& values);

}  // namespace compueye::recon
