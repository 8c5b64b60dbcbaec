#include "recon/setup/penalty_rule.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "recon/setup/row_norms.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {
namespace {

constexpr double share_of_column_norm = 0.06;
constexpr double share_for_differences = 0.1;
constexpr double steps_to_white = 4.0;

/// ||A D'||_F^2: over each row as a picture, the squared differences of neighbouring pixels. (a - b)^2 summed over
/// pairs is each square as often as it has neighbours, less twice the products.
double squared_difference_norm(const Response& response) {
  std::vector<double> picture(static_cast<std::size_t>(response.cols()), 0.0);
  const int image_rows = response.image_rows(), image_cols = response.image_cols();
  const auto width = static_cast<std::size_t>(image_cols);
  double sum = 0.0;
  for (int m = 0; m < response.rows(); ++m) {
    response.for_each_in_row(m, [&](std::int32_t n, double v) { picture[static_cast<std::size_t>(n)] = v; });
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      const int row = n / image_cols, col = n % image_cols;
      const bool has_right = col + 1 < image_cols, has_below = row + 1 < image_rows;
      const int neighbours = (col > 0 ? 1 : 0) + (has_right ? 1 : 0) + (row > 0 ? 1 : 0) + (has_below ? 1 : 0);
      const auto at = static_cast<std::size_t>(n);
      sum +=
          v * (neighbours * v - 2.0 * ((has_right ? picture[at + 1] : 0.0) + (has_below ? picture[at + width] : 0.0)));
    });
    response.for_each_in_row(m, [&](std::int32_t n, double) { picture[static_cast<std::size_t>(n)] = 0.0; });
  }
  return sum;
}

/// What rho is multiplied by where a few rows are far louder than the rest: their penalty is right while lambda is of
/// their size, that of the bulk where lambda / rho would otherwise be far below the picture's brightness.
double loudness_in_play(const Response& response, const Objective& objective) {
  const double whole = response.squared_norm(), bulk = bulk_squared_norm(response);
  if (!(bulk < whole)) return 1.0;
  const double white = objective.constraint == ConstraintKind::box ? std::max(objective.hi, -objective.lo) : 1.0;
  const double by_lambda = steps_to_white * objective.lambda / white / rho_by_columns(response);
  return std::clamp(by_lambda, bulk / whole, 1.0);
}

}  // namespace

double resolve_rho(const Response& response, const Objective& objective, const Plan& plan) {
  if (plan.solver->rho == RhoUse::lambda) return objective.lambda;
  if (plan.rho > 0.0) return plan.rho;
  if (plan.solver->rho_by_rule != nullptr) return plan.solver->rho_by_rule(response, objective, plan);
  const double loud = loudness_in_play(response, objective), by_columns = loud * rho_by_columns(response);
  if (metric_of(objective.basis) == MetricKind::identity) return by_columns;
  const double differences = squared_difference_norm(response);
  // Fields that cover the picture evenly have no edge at all.
  const double by_edges =
      loud * share_for_differences * std::sqrt(response.squared_norm()) * std::sqrt(std::max(differences, 0.0));
  return by_edges > 1e-3 * by_columns * response.cols() ? by_edges / response.cols() : by_columns;
}

double rho_by_columns(const Response& response) {
  return share_of_column_norm * response.squared_norm() / response.cols();
}

void push_geometric(double from, double to, int count, std::vector<double>& values) {
  for (int k = 1; k <= count; ++k) values.push_back(from * std::pow(to / from, static_cast<double>(k) / count));
}

PenaltyLevels penalty_levels(const Objective& objective, const Plan& plan, bool rho_by_rule, int order,
                             bool mirror_symmetric) {
  if (!rho_by_rule || plan.solver->penalties == nullptr) return {{plan.rho}, 1};
  return plan.solver->penalties(objective, plan, order, mirror_symmetric);
}

}  // namespace compueye::recon
