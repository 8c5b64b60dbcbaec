#include "recon/reconstructor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "recon/core/parts/frame_solver.hpp"
#include "recon/core/parts/warm_start.hpp"
#include "recon/core/parts/workspace.hpp"
#include "recon/number_text.hpp"
#include "recon/setup/deflation_rule.hpp"
#include "recon/setup/dual_step_tables.hpp"
#include "recon/setup/leading_modes.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/parity_classes.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/problem_checks.hpp"
#include "recon/setup/problem_tables.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;

}  // namespace

struct Reconstructor::Tables {
  int channels = 0;
  int image_rows = 0, image_cols = 0;
  Objective objective;
  Plan plan;
  bool rho_by_rule = false;
  std::vector<std::int32_t> seeing;
  Factor factor;  // of f32 the inverse in use; modes are only kept to be stored
  std::variant<OwnedTables<float>, OwnedTables<double>> by_precision;
  std::unique_ptr<WorkerThreads> workers;  // none where one thread does it all

  [[nodiscard]] hal::Result<void> employ_workers() {
    if (plan.threads == 1) return {};
    auto started = WorkerThreads::start(plan.threads);
    if (!started) return tl::unexpected(started.error());
    workers = std::move(*started);
    std::visit([&](auto& tables) { tables.problem.employ(workers->crew()); }, by_precision);
    return {};
  }

  template <class T>
  hal::Result<void> fill(const Response& response, std::optional<Factor> stored, const Progress& progress) {
    OwnedTables<T>& tables = by_precision.template emplace<OwnedTables<T>>();
    const Response sees = response.select_rows(seeing);
    if (auto filled = fill_operator(sees, plan.op, tables); !filled) return filled;
    fill_basis(objective.basis, image_rows, image_cols, tables);
    tables.problem.image_rows = static_cast<std::size_t>(image_rows);
    tables.problem.image_cols = static_cast<std::size_t>(image_cols);
    fill_choice(sees, objective, plan, tables);
    tables.problem.seeing = seeing.data();
    tables.problem.channels = static_cast<std::size_t>(channels);
    tables.problem.max_reweighted = static_cast<std::size_t>(plan.max_reweighted);
    if (plan.solver == SolverKind::tsvd) {
      return fill_modes(sees, objective, plan, progress, tables).map([&] {
        plan.rank = static_cast<int>(tables.problem.modes.rank);
      });
    }
    if (!uses_factor(plan.solver)) return {};
    return plan.solver == SolverKind::pdhg ? fill_dual_step(sees, tables, std::move(stored), progress)
                                           : fill_factor(sees, tables, std::move(stored), progress);
  }

  template <class T>
  hal::Result<void> fill_dual_step(const Response& sees, OwnedTables<T>& tables, std::optional<Factor> stored,
                                   const Progress& progress) {
    const ParityClasses classes(sees.rows(), find_mirror_symmetry(sees));
    if (stored && stored->values.size() != modes_size(classes, plan.rank)) return stale(*stored);
    if (stored) {
      factor.values = std::move(stored->values);
    } else {
      auto made = leading_modes(sees, plan.rank, progress);
      if (!made) return tl::unexpected(made.error());
      factor.values = std::move(*made);
    }
    const PenaltyLevels penalties = fill_schedule(classes, tables);
    tables.dual_step = dual_step_tables<T>(classes, factor.values, plan.rank, penalties.penalties,
                                           basis_share(objective.basis, plan.rank >= classes.rows()));
    tables.problem.dual_step = tables.dual_step.view;
    return {};
  }

  template <class T>
  hal::Result<void> fill_factor(const Response& sees, OwnedTables<T>& tables, std::optional<Factor> stored,
                                const Progress& progress) {
    std::vector<T>& inverse = inverse_of(tables);
    const ParityClasses classes(sees.rows(), find_mirror_symmetry(sees));
    if (stored && stored->values.size() != factor_size(classes)) return stale(*stored);
    if (stored && std::is_same_v<T, float>) {
      factor.values = std::move(stored->values);
    } else {
      auto made = packed_inverse<T>(sees, factor.metric, plan.rho, progress);
      if (!made) return tl::unexpected(made.error());
      inverse = std::move(*made);
    }
    fill_inverse(classes, inverse, tables);
    if (plan.solver == SolverKind::admm && objective.basis == BasisKind::identity) {
      const PenaltyLevels penalties = fill_schedule(classes, tables);
      tables.thin_step = thin_step_tables<T>(sees, classes, penalties.penalties);
      tables.problem.thin_step = tables.thin_step.view;
    }
    return {};
  }

  template <class T>
  PenaltyLevels fill_schedule(const ParityClasses& classes, OwnedTables<T>& tables) const {
    PenaltyLevels levels = penalty_levels(objective, plan, rho_by_rule, classes.rows(), classes.count() > 1);
    recon::fill_schedule(levels, tables);
    return levels;
  }

  std::vector<float>& inverse_of(OwnedTables<float>&) noexcept { return factor.values; }
  static std::vector<double>& inverse_of(OwnedTables<double>& tables) noexcept { return tables.inverse; }

  [[nodiscard]] hal::Result<void> check_stored(const Factor& stored) const {
    const bool fits = uses_factor(plan.solver) && stored.metric == factor.metric && stored.rho == factor.rho &&
                      stored.order == factor.order && stored.rank == factor.rank;
    return fits ? hal::Result<void>{} : stale(stored);
  }

  [[nodiscard]] hal::Result<void> stale(const Factor& stored) const {
    return fail(ErrorCode::stale, "factor",
                "was made for rho " + number_text(stored.rho) + " and " + std::to_string(stored.order) +
                    " seeing rows, this problem has rho " + number_text(plan.rho) + " and " +
                    std::to_string(seeing.size()));
  }
};

Reconstructor::Reconstructor(std::unique_ptr<Tables> tables) noexcept : tables_(std::move(tables)) {}
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;
Reconstructor::~Reconstructor() = default;

hal::Result<Reconstructor> Reconstructor::create(const Response& response, const Objective& objective, const Plan& plan,
                                                 std::optional<Factor> factor, const Progress& progress) {
  if (plan.op && is_lossy(*plan.op)) {
    return create_as_applied(quantised(response, *plan.op), objective, plan, std::move(factor), progress);
  }
  return create_as_applied(response, objective, plan, std::move(factor), progress);
}

hal::Result<Reconstructor> Reconstructor::create_as_applied(const Response& response, const Objective& objective,
                                                            const Plan& plan, std::optional<Factor> factor,
                                                            const Progress& progress) {
  const auto checked = check_choice(objective, plan);
  if (!checked) return tl::unexpected(checked.error());
  if (response.image_rows() == 0) {
    return fail(ErrorCode::mismatch, "size",
                "of the picture is not known, the response has " + std::to_string(response.cols()) + " columns");
  }
  auto tables = std::make_unique<Tables>();
  tables->channels = response.rows();
  tables->image_rows = response.image_rows();
  tables->image_cols = response.image_cols();
  tables->objective = objective;
  tables->plan = plan;
  tables->seeing = response.seeing_rows();
  if (tables->seeing.empty()) {
    return fail(ErrorCode::out_of_range, "response", "has no row with a non-zero entry: this eye sees nothing");
  }
  const double squares = response.squared_norm();
  if (auto ok = check_scale(squares, response.cols()); !ok) return tl::unexpected(ok.error());
  tables->plan.rho = resolve_rho(response, objective, plan);
  tables->rho_by_rule = plan.rho == 0.0;
  tables->factor = wanted_factor(response, objective, tables->plan);
  if (plan.solver == SolverKind::pdhg) tables->plan.rank = tables->factor.rank;
  if (auto ok = check_in_precision(squares, objective, tables->plan); !ok) return tl::unexpected(ok.error());
  const int most = static_cast<int>(tables->seeing.size());
  const int by_rule = (most + 9) / 10;
  tables->plan.max_reweighted = std::min(most, plan.max_reweighted < 0 ? by_rule : plan.max_reweighted);
  if (factor) {
    if (auto fits = tables->check_stored(*factor); !fits) return tl::unexpected(fits.error());
  }
  auto filled = plan.precision == Precision::f32 ? tables->fill<float>(response, std::move(factor), progress)
                                                 : tables->fill<double>(response, std::move(factor), progress);
  if (!filled) return tl::unexpected(filled.error());
  if (auto employed = tables->employ_workers(); !employed) return tl::unexpected(employed.error());
  return Reconstructor(std::move(tables));
}

Factor Reconstructor::wanted_factor(const Response& response, const Objective& objective, const Plan& plan) {
  const auto order = static_cast<int>(response.seeing_rows().size());
  const MetricKind metric = metric_of(plan.solver, objective.basis);
  if (plan.solver == SolverKind::pdhg) return {0.0, order, {}, metric, resolve_rank(plan, order)};
  return {resolve_rho(response, objective, plan), order, {}, metric, 0};
}

int Reconstructor::channels() const noexcept {
  return tables_->channels;
}
int Reconstructor::image_rows() const noexcept {
  return tables_->image_rows;
}
int Reconstructor::image_cols() const noexcept {
  return tables_->image_cols;
}
int Reconstructor::pixels() const noexcept {
  return tables_->image_rows * tables_->image_cols;
}
int Reconstructor::seeing_channels() const noexcept {
  return static_cast<int>(tables_->seeing.size());
}
const Objective& Reconstructor::objective() const noexcept {
  return tables_->objective;
}
const Plan& Reconstructor::plan() const noexcept {
  return tables_->plan;
}
const Factor& Reconstructor::factor() const noexcept {
  return tables_->factor;
}

OperatingPoint Reconstructor::operating_point() const noexcept {
  return std::visit([](const auto& tables) { return tables.problem.point; }, tables_->by_precision);
}

hal::Result<void> Reconstructor::set_iterations(int iterations) {
  Plan changed = tables_->plan;
  changed.iterations = iterations;
  return check_choice(tables_->objective, changed).map([&] {
    tables_->plan = changed;
    std::visit([&](auto& tables) { fill_iterations(changed, tables.problem); }, tables_->by_precision);
  });
}

const core::FrameProblem<float>* Reconstructor::frame_problem() const noexcept {
  const auto* tables = std::get_if<OwnedTables<float>>(&tables_->by_precision);
  return tables == nullptr ? nullptr : &tables->problem;
}

std::size_t Reconstructor::required_bytes() const noexcept {
  return std::visit([](const auto& tables) { return core::workspace_bytes(tables.problem); }, tables_->by_precision);
}

std::size_t Reconstructor::table_bytes() const noexcept {
  const std::size_t owned = std::visit([](const auto& tables) { return tables.bytes(); }, tables_->by_precision);
  return owned + tables_->factor.values.size() * sizeof(float) + tables_->seeing.size() * sizeof(std::int32_t);
}

void Reconstructor::forget_modes() noexcept {
  if (tables_->factor.rank > 0) std::vector<float>().swap(tables_->factor.values);
}

void Reconstructor::forget_last_frame(std::span<std::byte> workspace) const noexcept {
  if (plan().warm_start && workspace.size() >= required_bytes()) core::WarmStart<float>::forget(workspace.data());
}

FrameInfo Reconstructor::solve(std::span<const float> y, std::span<const float> weights, std::span<std::byte> workspace,
                               std::span<float> x) const noexcept {
  const bool aligned = reinterpret_cast<std::uintptr_t>(workspace.data()) % core::Workspace::alignment == 0;
  const auto channel_count = static_cast<std::size_t>(channels());
  if (!aligned || workspace.size() < required_bytes() || y.size() != channel_count ||
      (!weights.empty() && weights.size() != channel_count) || x.size() != static_cast<std::size_t>(pixels())) {
    std::fill(x.begin(), x.end(), 0.0F);
    FrameInfo refused;
    refused.point = operating_point();
    return refused;
  }
  const float* w = weights.empty() ? nullptr : weights.data();
  return std::visit(
      [&](const auto& tables) { return core::solve_frame(tables.problem, y.data(), w, workspace.data(), x.data()); },
      tables_->by_precision);
}

}  // namespace compueye::recon
