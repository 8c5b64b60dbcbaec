#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/parts/frame_problem.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/dense_run_tables.hpp"
#include "recon/setup/dual_step_tables.hpp"
#include "recon/setup/penalty_schedule.hpp"
#include "recon/setup/running_sum_tables.hpp"
#include "recon/setup/thin_step_tables.hpp"

namespace compueye::recon {

/// The tables a core::FrameProblem<T> looks at.
template <class T>
struct OwnedTables {
  std::vector<T> values;
  std::vector<std::uint32_t> row_start;
  std::vector<std::int32_t> columns;
  RunningSumTables<T> sums;
  DualStepTables<T> dual_step;
  ThinStepTables<T> thin_step;
  DenseRunTables<T> runs;
  std::vector<T> row_table;  // of the basis, or of the metric's DCT
  std::vector<T> col_table;
  std::vector<T> metric;
  std::vector<T> inverse;
  std::vector<std::int32_t> class_index;
  std::vector<T> class_share;
  std::vector<T> primal_steps;
  std::vector<T> dual_steps;
  std::vector<T> atom_norms;
  std::vector<T> modes;
  std::vector<T> mode_weights;
  std::vector<T> penalties;
  core::FrameProblem<T> problem;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return (values.size() + row_table.size() + col_table.size() + metric.size() + inverse.size() + primal_steps.size() +
            dual_steps.size() + atom_norms.size() + modes.size() + mode_weights.size() + class_share.size() +
            penalties.size()) *
               sizeof(T) +
           (row_start.size() + columns.size() + class_index.size()) * sizeof(std::uint32_t) + sums.bytes() +
           dual_step.bytes() + thin_step.bytes() + runs.bytes();
  }
};

/// A of the seeing rows in the form that choose_operator() finds, whose errors it has. For a lossy one `seeing` must be
/// what quantised() makes of the response.
template <class T>
[[nodiscard]] hal::Result<void> fill_operator(const Response& seeing, std::optional<OperatorKind> asked,
                                              OwnedTables<T>& tables);

/// Psi and the metric that goes with it.
template <class T>
void fill_basis(BasisKind kind, int image_rows, int image_cols, OwnedTables<T>& tables);

/// The numbers of objective and plan, and the step sizes and norms of solvers without a factor. After fill_operator()
/// and fill_basis().
template <class T>
void fill_choice(const Response& seeing, const Objective& objective, const Plan& plan, OwnedTables<T>& tables);

/// The penalties that iterations go through.
template <class T>
void fill_schedule(const PenaltyLevels& levels, OwnedTables<T>& tables);

/// The plan's iterations: one where the solver is direct.
template <class T>
void fill_iterations(const Plan& plan, core::FrameProblem<T>& problem);

/// Points problem.inverse at `values`, which are packed as Factor::values are.
template <class T>
void fill_inverse(const ParityClasses& classes, const std::vector<T>& values, OwnedTables<T>& tables);

/// The singular pairs that tsvd keeps. Errors: those of singular_modes().
template <class T>
[[nodiscard]] hal::Result<void> fill_modes(const Response& seeing, const Objective& objective, const Plan& plan,
                                           const Progress& progress, OwnedTables<T>& tables);

}  // namespace compueye::recon
