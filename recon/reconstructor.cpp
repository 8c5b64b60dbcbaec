#include "recon/reconstructor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "hal/try.hpp"
#include "recon/core/parts/workspace.hpp"
#include "recon/huber_passes.hpp"
#include "recon/problem_checks.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/rounded_form.hpp"
#include "recon/setup/shorter_side.hpp"
#include "recon/setup/solver_row.hpp"
#include "recon/setup/unit_choice.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;

template <class T>
using ProblemIn = std::shared_ptr<core::FrameProblem<T>>;

bool is_same(const Factor& stored, const Factor& wanted) noexcept {
  return wanted.order > 0 && stored.metric == wanted.metric && stored.rho == wanted.rho &&
         stored.order == wanted.order && stored.rank == wanted.rank;
}

}  // namespace

struct Reconstructor::Tables {
  int channels = 0;
  int image_rows = 0, image_cols = 0;
  Objective objective;
  Plan plan;
  bool rho_by_rule = false;
  std::vector<std::int32_t> seeing;
  UnitChoice unit;
  Factor factor;  // of f32 the inverse in use; modes are only kept to be stored
  KeptTables kept;
  std::unique_ptr<WorkerThreads> workers;  // none where one thread does it all
  std::variant<ProblemIn<float>, ProblemIn<double>> problem;

  [[nodiscard]] std::size_t frame_bytes() const noexcept;

  template <class T>
  hal::Result<void> prepare(const Response& response, std::optional<Factor> stored, const Progress& progress) {
    const std::vector<double> scale(unit.response == 0 ? 0 : seeing.size(), std::ldexp(1.0, unit.response));
    const Response sees = response.select_rows(seeing, scale);
    const Objective in_unit = unit.of_response(objective);
    SetUp<T> from{sees,
                  in_unit,
                  unit,
                  plan,
                  rho_by_rule,
                  seeing.data(),
                  channels,
                  factor,
                  std::move(stored),
                  progress,
                  workers == nullptr ? core::Crew{} : workers->crew(),
                  kept};
    plan.rho = unit.squared(plan.rho);
    problem = TRY(plan.solver->in<T>().prepare(from));
    plan.rho = unit.unsquared(plan.rho);
    return {};
  }

  [[nodiscard]] hal::Result<void> check_stored(const Factor& stored) const {
    return is_same(stored, factor) ? hal::Result<void>{} : stale(stored, plan, static_cast<int>(seeing.size()));
  }
};

/// `work` with the core solver and the problem in the plan's precision.
template <class Tables, class Work>
static auto with_problem(Tables& tables, const Work& work) {
  return std::visit(
      [&]<class T>(const ProblemIn<T>& problem) { return work(*tables.plan.solver->template in<T>().frame, *problem); },
      tables.problem);
}

std::size_t Reconstructor::Tables::frame_bytes() const noexcept {
  return with_problem(*this, [](const auto& solver, const auto& p) { return solver.bytes(p); });
}

Reconstructor::Reconstructor(std::unique_ptr<Tables> tables) noexcept : tables_(std::move(tables)) {}
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;
Reconstructor::~Reconstructor() = default;

hal::Result<Reconstructor> Reconstructor::create(const Response& response, const Objective& objective, const Plan& plan,
                                                 std::optional<Factor> factor, const Progress& progress) {
  const auto form = rounded_form(response, plan.op);
  Plan applied = plan;
  applied.op = applied_operator(form, plan.op);
  return create_as_applied(form ? form->response : response, objective, applied, std::move(factor), progress);
}

hal::Result<Reconstructor> Reconstructor::create_as_applied(const Response& response, const Objective& objective,
                                                            const Plan& plan, std::optional<Factor> factor,
                                                            const Progress& progress) {
  TRY(check_choice(objective, plan));
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
  TRY(check_scale(squares, response.cols()));
  tables->unit = choose_unit(squares, response.cols(), objective, plan);
  tables->plan.rho = resolve_rho(response, objective, plan);
  tables->rho_by_rule = plan.rho == 0.0;
  tables->factor = wanted_factor(response, objective, tables->plan);
  if (tables->factor.rank > 0) tables->plan.rank = tables->factor.rank;
  TRY(check_in_precision(squares, objective, tables->plan, tables->unit));
  const int most = static_cast<int>(tables->seeing.size());
  const int by_rule = (most + 9) / 10;
  tables->plan.max_reweighted = std::min(most, plan.max_reweighted < 0 ? by_rule : plan.max_reweighted);
  if (factor) TRY(tables->check_stored(*factor));
  if (plan.threads > 1) tables->workers = TRY(WorkerThreads::start(plan.threads));
  TRY(plan.precision == Precision::f32 ? tables->prepare<float>(response, std::move(factor), progress)
                                       : tables->prepare<double>(response, std::move(factor), progress));
  return Reconstructor(std::move(tables));
}

Factor Reconstructor::wanted_factor(const Response& response, const Objective& objective, const Plan& plan) {
  const auto order = static_cast<int>(response.seeing_rows().size());
  const MetricKind metric = metric_of(plan.solver, objective.basis);
  if (plan.solver->factor == FactorUse::modes) {
    return {0.0, order, {}, metric, plan.solver->rank_by_rule(plan, mode_count(order, response.cols()))};
  }
  const bool kept = uses_factor(plan.solver) && !is_tall(order, response.cols());
  const UnitChoice unit{response_exponent(response.squared_norm(), response.cols()), 0};
  return {unit.squared(resolve_rho(response, objective, plan)), kept ? order : 0, {}, metric, 0};
}

std::optional<Factor> factor_that_fits(const Factor& factor, const Response& response, const Objective& objective,
                                       const Plan& plan) {
  if (plan.precision != Precision::f32 || factor.values.empty()) return std::nullopt;
  if (!is_same(factor, Reconstructor::wanted_factor(response, objective, plan))) return std::nullopt;
  return factor;
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
  return with_problem(*tables_, [](const auto&, const auto& problem) { return problem.point; });
}

hal::Result<void> Reconstructor::set_iterations(int iterations) {
  Plan changed = tables_->plan;
  changed.iterations = iterations;
  TRY(check_choice(tables_->objective, changed));
  tables_->plan = changed;
  if (!changed.solver->direct) {
    std::visit([&](auto& problem) { problem->point.iterations = iterations; }, tables_->problem);
  }
  return {};
}

std::vector<std::byte> Reconstructor::freeze(const core::FrozenSamples& samples) const {
  const auto* problem = std::get_if<ProblemIn<float>>(&tables_->problem);
  return problem == nullptr || objective().huber ? std::vector<std::byte>() : plan().solver->freeze(**problem, samples);
}

std::size_t Reconstructor::required_bytes() const noexcept {
  core::Workspace counter;
  static_cast<void>(counter.take<std::byte>(tables_->frame_bytes()));
  if (objective().huber) {
    static_cast<void>(counter.take<std::byte>(least_residual_bytes()));
    static_cast<void>(HuberPasses(*objective().huber, channels(), plan().max_reweighted, counter));
  }
  return counter.used();
}

std::size_t Reconstructor::table_bytes() const noexcept {
  return tables_->kept.bytes() + tables_->factor.values.size() * sizeof(float) +
         tables_->seeing.size() * sizeof(std::int32_t);
}

void Reconstructor::forget_modes() noexcept {
  if (tables_->factor.rank > 0) std::vector<float>().swap(tables_->factor.values);
}

void Reconstructor::forget_last_frame(std::span<std::byte> workspace) const noexcept {
  if (!plan().warm_start || workspace.size() < required_bytes()) return;
  with_problem(*tables_, [&](const auto& solver, const auto&) { solver.forget(workspace.data()); });
}

bool Reconstructor::fits(std::span<const float> y, std::span<const float> weights, std::span<std::byte> workspace,
                         std::size_t bytes, std::span<const float> x) const noexcept {
  const bool aligned = reinterpret_cast<std::uintptr_t>(workspace.data()) % core::Workspace::alignment == 0;
  const auto channel_count = static_cast<std::size_t>(channels());
  return aligned && workspace.size() >= bytes && y.size() == channel_count &&
         (weights.empty() || weights.size() == channel_count) && x.size() == static_cast<std::size_t>(pixels());
}

FrameInfo Reconstructor::solve(std::span<const float> y, std::span<const float> weights, std::span<std::byte> workspace,
                               std::span<float> x) const noexcept {
  if (!fits(y, weights, workspace, required_bytes(), x)) {
    std::fill(x.begin(), x.end(), 0.0F);
    FrameInfo refused;
    refused.point = operating_point();
    return refused;
  }
  core::Workspace memory(workspace.data());
  auto* const frame = memory.take<std::byte>(tables_->frame_bytes());
  const auto once = [&](std::span<const float> with) {
    const float* w = with.empty() ? nullptr : with.data();
    return with_problem(*tables_, [&](const auto& solver, const auto& problem) {
      return solver.solve(problem, y.data(), w, frame, x.data());
    });
  };
  if (!objective().huber) return once(weights);
  const std::size_t bytes = least_residual_bytes();
  const std::span<std::byte> room(memory.take<std::byte>(bytes), bytes);
  HuberPasses passes(*objective().huber, channels(), plan().max_reweighted, memory);
  return passes.run(weights, once,
                    [&](std::span<float> residuals) { channel_residuals(y, weights, room, x, residuals); });
}

std::size_t Reconstructor::least_residual_bytes() const noexcept {
  return with_problem(*tables_, [](const auto&, const auto& problem) { return core::least_residual_bytes(problem); });
}

core::LeastResidual Reconstructor::least_residual(std::span<const float> y, std::span<const float> weights,
                                                  std::span<std::byte> workspace,
                                                  std::span<const float> x) const noexcept {
  if (!fits(y, weights, workspace, least_residual_bytes(), x)) return {};
  const float* w = weights.empty() ? nullptr : weights.data();
  return with_problem(*tables_, [&](const auto&, const auto& problem) {
    return core::least_residual(problem, y.data(), w, x.data(), workspace.data());
  });
}

void Reconstructor::channel_residuals(std::span<const float> y, std::span<const float> weights,
                                      std::span<std::byte> workspace, std::span<const float> x,
                                      std::span<float> residuals) const noexcept {
  std::fill(residuals.begin(), residuals.end(), 0.0F);
  if (!fits(y, weights, workspace, least_residual_bytes(), x) || residuals.size() != y.size()) return;
  const float* w = weights.empty() ? nullptr : weights.data();
  with_problem(*tables_, [&](const auto&, const auto& problem) {
    core::channel_residuals(problem, y.data(), w, x.data(), workspace.data(), residuals.data());
  });
}

}  // namespace compueye::recon
