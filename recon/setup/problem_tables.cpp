#include "recon/setup/problem_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "recon/setup/atom_norms.hpp"
#include "recon/setup/dct_tables.hpp"
#include "recon/setup/deflation_rule.hpp"
#include "recon/setup/fourier_tables.hpp"
#include "recon/setup/operator_choice.hpp"
#include "recon/setup/parity_classes.hpp"
#include "recon/setup/singular_modes.hpp"
#include "recon/setup/smoothing.hpp"
#include "recon/setup/step_sizes.hpp"

namespace compueye::recon {
namespace {

/// What only double can tell from nought would be a subnormal number in every product.
template <class T>
T kept(double value) {
  return std::abs(value) < static_cast<double>(std::numeric_limits<T>::min()) ? T(0) : static_cast<T>(value);
}

template <class T>
void fill_dense(const Response& seeing, OwnedTables<T>& tables) {
  const auto cols = static_cast<std::size_t>(seeing.cols());
  tables.values.assign(static_cast<std::size_t>(seeing.rows()) * cols, T(0));
  for (int m = 0; m < seeing.rows(); ++m) {
    T* row = tables.values.data() + static_cast<std::size_t>(m) * cols;
    seeing.for_each_in_row(m, [&](std::int32_t n, double v) { row[n] = kept<T>(v); });
  }
}

template <class T>
void fill_sparse(const Response& seeing, OwnedTables<T>& tables) {
  tables.row_start.push_back(0);
  for (int m = 0; m < seeing.rows(); ++m) {
    seeing.for_each_in_row(m, [&](std::int32_t n, double v) {
      const T value = kept<T>(v);
      if (value == T(0)) return;
      tables.values.push_back(value);
      tables.columns.push_back(n);
    });
    tables.row_start.push_back(static_cast<std::uint32_t>(tables.values.size()));
  }
}

core::RunValues run_values_of(OperatorKind kind) {
  if (kind == OperatorKind::dense_runs_bf16) return core::RunValues::bf16;
  return kind == OperatorKind::dense_runs_int8 ? core::RunValues::int8 : core::RunValues::full;
}

template <class T>
void fill_numbers(const Objective& objective, const Plan& plan, core::FrameProblem<T>& problem) {
  constexpr T infinity = std::numeric_limits<T>::infinity();
  problem.constrained = objective.constraint != ConstraintKind::none;
  const bool box = objective.constraint == ConstraintKind::box;
  problem.lo = box ? static_cast<T>(objective.lo) : T(0);
  problem.hi = box ? static_cast<T>(objective.hi) : infinity;
  problem.lambda = static_cast<T>(objective.lambda);
  problem.bounded = objective.epsilon.has_value();
  problem.epsilon = static_cast<T>(objective.epsilon.value_or(0.0));
  problem.measure_gap = plan.measure_gap;
  problem.warm_start = plan.warm_start;
  problem.l1_reweighting = static_cast<T>(plan.l1_reweighting);
  problem.rho = static_cast<T>(plan.rho);
  problem.relaxation = static_cast<T>(plan.relaxation);
  problem.point.basis = objective.basis;
  problem.point.solver = plan.solver;
  problem.point.precision = plan.precision;
  fill_iterations(plan, problem);
  problem.point.op = problem.a.kind;
}

}  // namespace

template <class T>
hal::Result<void> fill_operator(const Response& seeing, std::optional<OperatorKind> asked, OwnedTables<T>& tables) {
  const auto chosen = choose_operator(seeing, asked);
  if (!chosen) return tl::unexpected(chosen.error());
  core::LinearOperator<T>& a = tables.problem.a;
  a.kind = chosen->kind;
  a.rows = static_cast<std::size_t>(seeing.rows());
  a.cols = static_cast<std::size_t>(seeing.cols());
  switch (a.kind) {
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal:
      tables.sums = running_sum_tables<T>(seeing, chosen->images, chosen->transposed).value();
      a.sums = tables.sums.view;
      return {};
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      tables.runs = dense_run_tables<T>(seeing, run_values_of(a.kind)).value();
      a.runs = tables.runs.view;
      return {};
    case OperatorKind::dense:
      fill_dense(seeing, tables);
      break;
    case OperatorKind::csr:
      fill_sparse(seeing, tables);
      break;
  }
  a.values = tables.values.data();
  a.row_start = tables.row_start.data();
  a.columns = tables.columns.data();
  return {};
}

template <class T>
void fill_basis(BasisKind kind, int image_rows, int image_cols, OwnedTables<T>& tables) {
  const auto rows = static_cast<std::size_t>(image_rows), cols = static_cast<std::size_t>(image_cols);
  core::Basis<T>& psi = tables.problem.psi;
  psi.kind = kind;
  psi.rows = rows;
  psi.cols = cols;
  if (kind == BasisKind::dft) {
    tables.row_table = make_fourier_table<T>(image_rows);
    tables.col_table = make_fourier_table<T>(image_cols);
    psi.fourier = {rows, cols, tables.row_table.data(), tables.col_table.data()};
  }
  if (kind != BasisKind::dct && kind != BasisKind::tv) return;
  tables.row_table = make_dct_table<T>(image_rows);
  tables.col_table = make_dct_table<T>(image_cols);
  psi.dct = {{rows, tables.row_table.data()}, {cols, tables.col_table.data()}};
  if (kind != BasisKind::tv) return;
  for (const double eigenvalue : smoothing_eigenvalues(image_rows, image_cols)) {
    tables.metric.push_back(static_cast<T>(1.0 / eigenvalue));
  }
  tables.problem.metric = {tables.metric.data(), psi.dct};
}

template <class T>
void fill_choice(const Response& seeing, const Objective& objective, const Plan& plan, OwnedTables<T>& tables) {
  core::FrameProblem<T>& problem = tables.problem;
  fill_numbers(objective, plan, problem);
  const auto values = seeing.values();
  problem.column_norm = static_cast<T>(std::sqrt(seeing.squared_norm() / seeing.cols()));
  const double magnitudes =
      std::accumulate(values.begin(), values.end(), 0.0, [](double sum, double v) { return sum + std::abs(v); });
  problem.mean_row_sum = static_cast<T>(magnitudes / seeing.rows());
  if (plan.solver == SolverKind::omp) {
    const std::vector<double> norms = atom_norms(seeing, objective.basis);
    tables.atom_norms.assign(norms.begin(), norms.end());
    problem.atom_norms = tables.atom_norms.data();
  }
  if (plan.solver == SolverKind::fista) problem.lipschitz = static_cast<T>(squared_norm_bound(seeing));
  if (plan.solver == SolverKind::pdhg) {
    problem.basis_step = static_cast<T>(basis_share(objective.basis, plan.rank >= seeing.rows()) * plan.rho /
                                        problem.psi.squared_norm());
  }
  if (plan.solver != SolverKind::chambolle_pock) return;
  const PrimalDualSteps steps = primal_dual_steps(seeing, problem.psi.squared_norm());
  tables.primal_steps.assign(steps.primal.begin(), steps.primal.end());
  tables.dual_steps.assign(steps.dual.begin(), steps.dual.end());
  problem.primal_steps = tables.primal_steps.data();
  problem.dual_steps = tables.dual_steps.data();
  problem.basis_step = static_cast<T>(steps.basis);
}

template <class T>
void fill_schedule(const PenaltyLevels& levels, OwnedTables<T>& tables) {
  for (const double penalty : levels.penalties) tables.penalties.push_back(static_cast<T>(penalty));
  tables.problem.schedule = {tables.penalties.size(), static_cast<std::size_t>(levels.iterations_a_level),
                             tables.penalties.data()};
}

template <class T>
void fill_iterations(const Plan& plan, core::FrameProblem<T>& problem) {
  const bool direct = plan.solver == SolverKind::tikhonov || plan.solver == SolverKind::tsvd;
  problem.point.iterations = direct ? 1 : plan.iterations;
}

template <class T>
void fill_inverse(const ParityClasses& classes, const std::vector<T>& values, OwnedTables<T>& tables) {
  core::ClassInverse<T>& inverse = tables.problem.inverse;
  inverse.order = static_cast<std::size_t>(classes.rows());
  inverse.classes = classes.count();
  for (std::size_t c = 0; c < classes.count() && classes.count() > 1; ++c) {
    for (int m = 0; m < classes.rows(); ++m) {
      tables.class_index.push_back(classes.index(c, m));
      tables.class_share.push_back(static_cast<T>(classes.share(c, m)));
    }
  }
  std::size_t first = 0;
  for (std::size_t c = 0; c < classes.count(); ++c) {
    auto& part = inverse.parts[c];
    part.matrix = {static_cast<std::size_t>(classes.order(c)), values.data() + first};
    first += core::PackedSymmetric<T>::size(part.matrix.order);
    if (classes.count() == 1) continue;
    part.index = tables.class_index.data() + c * inverse.order;
    part.share = tables.class_share.data() + c * inverse.order;
  }
}

template <class T>
hal::Result<void> fill_modes(const Response& seeing, const Objective& objective, const Plan& plan,
                             const Progress& progress, OwnedTables<T>& tables) {
  core::FrameProblem<T>& problem = tables.problem;
  const double least_square = plan.rank > 0 ? 0.0 : objective.lambda;
  auto found = singular_modes(seeing, plan.rank, least_square, progress);
  if (!found) return tl::unexpected(found.error());
  tables.modes.assign(found->left.begin(), found->left.end());
  for (const double value : found->values) tables.mode_weights.push_back(static_cast<T>(1.0 / (value * value)));
  problem.modes = {found->values.size(), tables.modes.data(), tables.mode_weights.data()};
  return {};
}

template void fill_iterations(const Plan&, core::FrameProblem<float>&);
template void fill_schedule(const PenaltyLevels&, OwnedTables<float>&);
template void fill_schedule(const PenaltyLevels&, OwnedTables<double>&);
template void fill_iterations(const Plan&, core::FrameProblem<double>&);
template void fill_inverse(const ParityClasses&, const std::vector<float>&, OwnedTables<float>&);
template void fill_inverse(const ParityClasses&, const std::vector<double>&, OwnedTables<double>&);
template hal::Result<void> fill_modes(const Response&, const Objective&, const Plan&, const Progress&,
                                      OwnedTables<float>&);
template hal::Result<void> fill_modes(const Response&, const Objective&, const Plan&, const Progress&,
                                      OwnedTables<double>&);
template hal::Result<void> fill_operator(const Response&, std::optional<OperatorKind>, OwnedTables<float>&);
template hal::Result<void> fill_operator(const Response&, std::optional<OperatorKind>, OwnedTables<double>&);
template void fill_basis(BasisKind, int, int, OwnedTables<float>&);
template void fill_basis(BasisKind, int, int, OwnedTables<double>&);
template void fill_choice(const Response&, const Objective&, const Plan&, OwnedTables<float>&);
template void fill_choice(const Response&, const Objective&, const Plan&, OwnedTables<double>&);

}  // namespace compueye::recon
