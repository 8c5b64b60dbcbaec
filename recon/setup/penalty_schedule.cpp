#include "recon/setup/penalty_schedule.hpp"

#include <cmath>

#include "recon/setup/solver_row.hpp"

namespace compueye::recon {

void push_geometric(double from, double to, int count, std::vector<double>& values) {
  for (int k = 1; k <= count; ++k) values.push_back(from * std::pow(to / from, static_cast<double>(k) / count));
}

PenaltyLevels penalty_levels(const Objective& objective, const Plan& plan, bool rho_by_rule, int order,
                             bool mirror_symmetric) {
  if (!rho_by_rule || plan.solver->penalties == nullptr) return {{plan.rho}, 1};
  return plan.solver->penalties(objective, plan, order, mirror_symmetric);
}

}  // namespace compueye::recon
