#include "recon/penalty_rule.hpp"

namespace compueye::recon {

double resolve_rho(const Response& response, const Objective& objective, const Plan& plan) {
  if (plan.solver == SolverKind::tikhonov) return objective.lambda;
  if (plan.rho > 0.0) return plan.rho;
  (void)response;
  return 4.0 * (objective.lambda > 0 ? objective.lambda : 1e-3);
}

}  // namespace compueye::recon
