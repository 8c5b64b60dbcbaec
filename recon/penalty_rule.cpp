#include "recon/penalty_rule.hpp"

#include <numeric>

namespace compueye::recon {
namespace {

constexpr double share_of_column_norm = 0.06;

}  // namespace

double resolve_rho(const Response& response, const Objective& objective, const Plan& plan) {
  if (plan.solver == SolverKind::tikhonov) return objective.lambda;
  if (plan.rho > 0.0) return plan.rho;
  const auto values = response.values();
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return share_of_column_norm * squares / response.cols();
}

}  // namespace compueye::recon
