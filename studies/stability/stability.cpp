#include "studies/stability/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/text/words.hpp"
#include "hal/try.hpp"
#include "recon/condition_number.hpp"
#include "recon/solver_list.hpp"
#include "studies/named_kinds.hpp"
#include "studies/stability/case_run.hpp"
#include "studies/stability/optimum_bound.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using recon::ConstraintKind;

/// Of "converged": twice what recon promises, since a lower bound may itself be off.
constexpr double promised = 2e-3;

Result<std::vector<HardCase>> chosen_cases(const std::vector<std::string>& names) {
  std::vector<std::string_view> known;
  for (const HardCase& hard : hard_cases()) known.push_back(hard.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    return hal::fail(ErrorCode::usage, "--cases",
                     fmt::format("is '{}', which is no case{}", name, suggestion(name, known)));
  }
  std::vector<HardCase> chosen;
  for (const HardCase& hard : hard_cases()) {
    if (names.empty() || std::find(names.begin(), names.end(), hard.name) != names.end()) chosen.push_back(hard);
  }
  return chosen;
}

/// What a solver takes: the wanted constraint, else none; nothing where it does not take the basis.
std::optional<ConstraintKind> taken(recon::SolverKind solver, const recon::Objective& wanted) {
  for (const ConstraintKind constraint : {wanted.constraint, ConstraintKind::none}) {
    if (recon::supports(solver, wanted.basis, constraint)) return constraint;
  }
  return std::nullopt;
}

StableEnd end_of(const CaseFrame& frame, const StableRun& run) {
  const bool finite = std::isfinite(frame.info.objective) && std::isfinite(run.objective) &&
                      std::all_of(frame.x.begin(), frame.x.end(), [](float v) { return std::isfinite(v); });
  if (!finite) return StableEnd::wrong;
  if (frame.info.health == recon::Health::invalid) return StableEnd::invalid;
  if (frame.info.health != recon::Health::converged) return StableEnd::budget_used;
  return run.accuracy.value_or(0.0) > promised ? StableEnd::wrong : StableEnd::converged;
}

/// The runs of one case; what is known of the optimum serves all that minimise the same.
class CaseRuns {
 public:
  CaseRuns(const HardCase& hard, const HardProblem& problem, const StabilityOptions& options)
      : hard_(hard), problem_(problem), options_(options) {}

  [[nodiscard]] StableRun run(recon::SolverKind solver, ConstraintKind constraint, recon::Precision precision) {
    recon::Objective objective = with_lambda(options_.objective, hard_, problem_, solver);
    objective.constraint = constraint;
    StableRun run{solver, constraint, precision, StableEnd::refused, {}, {}, 0.0};
    const auto frame = run_case(problem_, objective, {solver, precision, options_.iterations});
    if (!frame) {
      run.refusal = frame.error().text();
      return run;
    }
    OptimumBound& bound = bound_of(objective);
    run.objective = bound.objective(frame->x);
    if (solver->minimises && bound.bound()) {
      const double over = run.objective - *bound.bound();
      run.accuracy = run.objective > 0.0 ? std::max(0.0, over) / run.objective : 0.0;
    }
    run.end = end_of(*frame, run);
    return run;
  }

 private:
  OptimumBound& bound_of(const recon::Objective& objective) {
    auto& known = bounds_[objective.constraint == ConstraintKind::none ? 0 : 1];
    if (!known) {
      recon::Objective minimised = objective;
      minimised.lambda = with_lambda(options_.objective, hard_, problem_, recon::default_solver()).lambda;
      known.emplace(problem_, minimised);
      known->prove(options_.iterations);
    }
    return *known;
  }

  const HardCase& hard_;
  const HardProblem& problem_;
  const StabilityOptions& options_;
  std::array<std::optional<OptimumBound>, 2> bounds_;
};

Result<void> check_eye(const recon::Response& eye, const std::string& name) {
  if (eye.seeing_rows().empty()) {
    return hal::fail(ErrorCode::out_of_range, name, "sees nothing, expected a response with an entry");
  }
  const std::int64_t entries = std::int64_t{eye.rows()} * eye.cols();
  if (entries <= most_entries_for_stability) return {};
  return hal::fail(
      ErrorCode::out_of_range, name,
      fmt::format("has {} x {} entries, expected at most {}: cases are solved dense and in double. A board "
                  "of 8 x 8 ommatidia shows the same",
                  eye.rows(), eye.cols(), most_entries_for_stability));
}

}  // namespace

std::string_view name(StableEnd end) noexcept {
  constexpr std::array<std::string_view, 5> words{"converged", "budget used", "invalid", "refused", "wrong"};
  return words[static_cast<std::size_t>(end)];
}

Result<Stability> measure_stability(const recon::Response& eye, const std::string& name,
                                    const StabilityOptions& options, const recon::Progress& progress) {
  const auto solvers = TRY(kinds_of("--solvers", options.solvers, recon::solver_names()));
  const auto chosen = TRY(chosen_cases(options.cases));
  TRY(check_eye(eye, name));
  Stability all{name, eye.rows(), eye.image_rows(), eye.image_cols(), options, {}, chosen.size()};
  for (const HardCase& hard : chosen) {
    const HardProblem problem = pose(hard, eye, options.seed);
    CaseRuns runs(hard, problem, options);
    StableCase one{hard, recon::condition_number(problem.a), {}};
    for (const recon::SolverKind solver : solvers) {
      const auto constraint = taken(solver, options.objective);
      if (!constraint) continue;
      const double done = static_cast<double>(all.cases.size()) +
                          static_cast<double>(one.runs.size()) / (2.0 * static_cast<double>(solvers.size()));
      if (progress && !progress("hard cases", done, static_cast<double>(chosen.size()))) {
        if (all.cases.empty()) return hal::fail(ErrorCode::interrupted, name, "stopped before the first case was done");
        return all;
      }
      for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
        one.runs.push_back(runs.run(solver, *constraint, precision));
      }
    }
    all.cases.push_back(std::move(one));
  }
  return all;
}

}  // namespace compueye::firmware
