#include "recon/setup/solver_row.hpp"

#include <cmath>
#include <string>

#include "recon/problem/number_text.hpp"
#include "recon/setup/basis_list.hpp"
#include "recon/setup/operator_list.hpp"

namespace compueye::recon {
namespace {

/// Whether x grows with y: an l1 term, a bound or a box is a size to compare with, and so is the last frame.
bool is_homogeneous(const Objective& objective, const Plan& plan) {
  if (plan.solver->lambda == LambdaUse::variances) return true;
  return objective.lambda == 0.0 && !objective.epsilon && objective.constraint != ConstraintKind::box &&
         plan.l1_reweighting == 0.0 && !plan.warm_start;
}

template <class T>
void fill_objective(const Objective& objective, int picture, core::FrameProblem<T>& problem) {
  const auto in_unit = [picture](double value) { return static_cast<T>(std::ldexp(value, picture)); };
  const bool box = objective.constraint == ConstraintKind::box;
  problem.constrained = objective.constraint != ConstraintKind::none;
  if (problem.constrained) problem.lo = box ? in_unit(objective.lo) : T(0);
  if (box) problem.hi = in_unit(objective.hi);
  problem.lambda = in_unit(objective.lambda);
  problem.bounded = objective.epsilon.has_value();
  problem.epsilon = in_unit(objective.epsilon.value_or(0.0));
}

}  // namespace

template <class T>
hal::Result<void> fill_shared(const SetUp<T>& from, core::FrameProblem<T>& problem) {
  const Plan& plan = from.plan;
  const int rows = from.seeing.image_rows(), cols = from.seeing.image_cols();
  problem.a = TRY(make_operator<T>(from.seeing, plan.op, from.kept));
  problem.psi = make_basis<T>(from.objective.basis, rows, cols, from.kept);
  problem.metric = make_metric(problem.psi, from.kept);
  problem.seeing = from.seeing_channels;
  problem.channels = static_cast<std::size_t>(from.channels);
  problem.max_reweighted = static_cast<std::size_t>(plan.max_reweighted);
  problem.image_rows = static_cast<std::size_t>(rows);
  problem.image_cols = static_cast<std::size_t>(cols);
  fill_objective(from.objective, from.unit.picture, problem);
  problem.unit = from.unit.of_frames();
  problem.homogeneous = is_homogeneous(from.objective, plan);
  problem.measure_gap = plan.measure_gap;
  problem.point = {problem.a.kind, from.objective.basis, plan.solver, plan.precision,
                   plan.solver->direct ? 1 : plan.iterations};
  problem.crew = problem.a.crew = problem.psi.dct.crew = problem.metric.dct.crew = from.crew;
  return {};
}

hal::Result<void> stale(const Factor& stored, const Plan& plan, int seeing) {
  return hal::fail(hal::ErrorCode::stale, "factor",
                   "was made for rho " + number_text(stored.rho) + " and " + std::to_string(stored.order) +
                       " seeing rows, this problem has rho " + number_text(plan.rho) + " and " +
                       std::to_string(seeing));
}

hal::Result<void> not_a_factor() {
  return hal::fail(hal::ErrorCode::stale, "factor",
                   "has the right checksums, but not the values of this response: it was damaged before it was stored, "
                   "or somebody else made it");
}

template <class T>
core::PenaltySchedule<T> schedule_of(const PenaltyLevels& levels, KeptTables& kept) {
  const std::vector<T> penalties(levels.penalties.begin(), levels.penalties.end());
  return {penalties.size(), static_cast<std::size_t>(levels.iterations_a_level), kept.keep(penalties)};
}

template hal::Result<void> fill_shared(const SetUp<float>&, core::FrameProblem<float>&);
template hal::Result<void> fill_shared(const SetUp<double>&, core::FrameProblem<double>&);
template core::PenaltySchedule<float> schedule_of(const PenaltyLevels&, KeptTables&);
template core::PenaltySchedule<double> schedule_of(const PenaltyLevels&, KeptTables&);

}  // namespace compueye::recon
