#include "tests/hard/hard_run.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/solve_frame.hpp"

namespace compueye::tests {
namespace {

/// The smallest or largest rho that set-up allows, and a share of it.
double rho_of(const HardRow& row, recon::Precision precision, double squares) {
  const double rounding = precision == recon::Precision::f32
                              ? static_cast<double>(std::numeric_limits<float>::epsilon())
                              : std::numeric_limits<double>::epsilon();
  if (row.rho_share > 0.0) return row.rho_share * squares * rounding * rounding * (1.0 + 1e-12);
  return -row.rho_share * squares / rounding * (1.0 - 1e-12);
}

}  // namespace

std::string HardSetting::name() const {
  return std::string(recon::name(solver)) + ' ' + std::string(recon::name(basis)) + ' ' +
         std::string(recon::name(constraint)) + ' ' + std::string(recon::name(precision));
}

std::vector<HardSetting> settings_of(const HardRow& row) {
  std::vector<HardSetting> all;
  for (const auto& solver : recon::solver_names()) {
    for (const auto& basis : recon::basis_names()) {
      for (const auto& constraint : recon::constraint_names()) {
        const bool wanted =
            lists(row.solvers, solver.name) && lists(row.bases, basis.name) && lists(row.constraints, constraint.name);
        if (!wanted || !recon::supports(solver.kind, basis.kind, constraint.kind)) continue;
        for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
          all.push_back({solver.kind, basis.kind, constraint.kind, precision});
        }
      }
    }
  }
#if defined(COMPUEYE_SANITIZED)
  constexpr std::size_t one_in = 11;
  std::vector<HardSetting> few;
  for (std::size_t k = std::hash<std::string_view>{}(row.hard.name) % std::min(one_in, all.size()); k < all.size();
       k += one_in) {
    few.push_back(all[k]);
  }
  return few;
#else
  return all;
#endif
}

recon::Objective objective_of(const HardRow& row, const HardSetting& setting, const firmware::HardProblem& problem) {
  recon::Objective objective;
  objective.basis = setting.basis;
  objective.constraint = setting.constraint;
  objective.lambda = row.hard.lambda_share * firmware::lambda_of_zero(problem, setting.basis);
  // Of the direct methods' squares: lambda is then a share of ||A||_F^2.
  if (!setting.solver->minimises && setting.solver->direct) {
    objective.lambda = row.hard.lambda_share * std::max(problem.a.squared_norm(), 1e-70);
  }
  return objective;
}

recon::Plan plan_of(const HardRow& row, const HardSetting& setting, const firmware::HardProblem& problem) {
  recon::Plan plan;
  plan.solver = setting.solver;
  plan.precision = setting.precision;
  plan.iterations = row.iterations;
  plan.measure_gap = true;
  if (row.rho_share != 0.0) plan.rho = rho_of(row, setting.precision, problem.a.squared_norm());
  plan.max_reweighted = static_cast<int>(
      std::count_if(problem.weights.begin(), problem.weights.end(), [](float w) { return w != 1.0F; }));
  return plan;
}

HardRun run(const recon::Objective& objective, const recon::Plan& plan, const firmware::HardProblem& problem) {
  HardRun result;
  result.objective = objective;
  const auto solver = recon::Reconstructor::create(problem.a, objective, plan);
  if (!solver) {
    result.refused = solver.error();
    return result;
  }
  SolvedFrame frame = solve_frame(*solver, problem.y, problem.weights);
  result.info = frame.info;
  result.x = std::move(frame.x);
  return result;
}

HardRun run(const HardRow& row, const HardSetting& setting, const firmware::HardProblem& problem) {
  return run(objective_of(row, setting, problem), plan_of(row, setting, problem), problem);
}

}  // namespace compueye::tests
