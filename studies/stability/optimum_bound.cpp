#include "studies/stability/optimum_bound.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "recon/setup/basis_list.hpp"
#include "recon/solver_list.hpp"
#include "studies/stability/case_run.hpp"

namespace compueye::firmware {

OptimumBound::OptimumBound(const HardProblem& problem, const recon::Objective& objective)
    : problem_(problem), objective_(objective) {}

double OptimumBound::objective(std::span<const float> x) const {
  const std::vector<double> pixels(x.begin(), x.end());
  std::vector<double> r(problem_.y.size());
  problem_.a.forward(pixels, r);
  double value = 0.0;
  for (const std::int32_t row : problem_.a.seeing_rows()) {
    const auto m = static_cast<std::size_t>(row);
    const double w = problem_.weights.empty() ? 1.0 : static_cast<double>(problem_.weights[m]);
    const double off = w > 0.0 ? r[m] - static_cast<double>(problem_.y[m]) : 0.0;
    value += 0.5 * w * off * off;
  }
  recon::KeptTables kept;
  const auto psi = recon::make_basis<double>(objective_.basis, problem_.a.image_rows(), problem_.a.image_cols(), kept);
  std::vector<double> coefficients(psi.coefficients()), scratch(psi.scratch_size());
  recon::core::analyse(psi, pixels.data(), coefficients.data(), scratch.data());
  double magnitudes = 0.0;
  for (const double c : coefficients) magnitudes += std::abs(c);
  return value + objective_.lambda * magnitudes;
}

void OptimumBound::prove(int iterations) {
  constexpr double near = 1e-6;
  constexpr int longer = 10;
  for (const int count : {iterations, longer * iterations}) {
    for (const recon::SolverKind solver : recon::solvers()) {
      if (!solver->minimises || !recon::supports(solver, objective_.basis, objective_.constraint)) continue;
      const auto run = run_case(problem_, objective_, {solver, recon::Precision::f64, count});
      if (!run || run->info.health == recon::Health::invalid || run->info.duality_gap < 0.0) continue;
      const double least = run->info.objective - run->info.duality_gap;
      if (std::isfinite(least)) bound_ = std::max(bound_.value_or(0.0), least);
      if (run->info.duality_gap <= near * run->info.objective) return;
    }
  }
}

}  // namespace compueye::firmware
