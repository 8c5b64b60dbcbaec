#include "recon/problem_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "recon/option_names.hpp"
#include "recon/problem/number_text.hpp"
#include "recon/solver_list.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;

hal::Result<void> out_of_range(const char* what, double value, const char* expected) {
  return fail(ErrorCode::out_of_range, what, "is " + number_text(value) + ", expected " + expected);
}

hal::Result<void> check_objective(const Objective& objective) {
  if (!std::isfinite(objective.lambda) || objective.lambda < 0.0) {
    return out_of_range("lambda", objective.lambda, "a finite number of 0 or more");
  }
  if (objective.epsilon && !(std::isfinite(*objective.epsilon) && *objective.epsilon >= 0.0)) {
    return out_of_range("epsilon", *objective.epsilon, "a finite number of 0 or more");
  }
  if (objective.huber && !(std::isfinite(*objective.huber) && *objective.huber > 0.0)) {
    return out_of_range("huber", *objective.huber, "a finite number above 0");
  }
  const bool ordered = std::isfinite(objective.lo) && std::isfinite(objective.hi) && objective.lo < objective.hi;
  if (objective.constraint == ConstraintKind::box && !ordered) {
    return fail(ErrorCode::out_of_range, "box",
                "is [" + number_text(objective.lo) + ", " + number_text(objective.hi) +
                    "], expected two finite numbers with the lower first");
  }
  return {};
}

hal::Result<void> check_plan(const Plan& plan) {
  if (plan.solver == nullptr) {
    return fail(ErrorCode::usage, "solver",
                "is none, expected one of " + names_of_solvers([](const auto&) { return true; }));
  }
  if (plan.iterations < 1 || plan.iterations > 1'000'000) {
    return out_of_range("iterations", plan.iterations, "1 to 1000000");
  }
  if (!(plan.relaxation > 0.0 && plan.relaxation < 2.0)) {
    return out_of_range("relaxation", plan.relaxation, "more than 0 and less than 2");
  }
  if (!std::isfinite(plan.rho) || plan.rho < 0.0)
    return out_of_range("rho", plan.rho, "more than 0, or 0 for the rule");
  if (!std::isfinite(plan.l1_reweighting) || plan.l1_reweighting < 0.0) {
    return out_of_range("l1 reweighting", plan.l1_reweighting, "a brightness above 0, or 0 for one pass");
  }
  static_assert(WorkerThreads::most == 64);
  if (plan.threads < 1 || plan.threads > WorkerThreads::most) {
    return out_of_range("threads", plan.threads, "1 to 64");
  }
  if (plan.rank < 0) return out_of_range("rank", plan.rank, "1 or more, or 0 for as many as lambda says");
  return {};
}

hal::Result<void> check_pair(const Objective& objective, const Plan& plan) {
  if (!supports(plan.solver, objective.basis, objective.constraint)) {
    return fail(ErrorCode::usage, "solver",
                std::string(name(plan.solver)) + " does not take basis " + std::string(name(objective.basis)) +
                    " with constraint " + std::string(name(objective.constraint)) +
                    "; these solvers do: " + solvers_for(objective.basis, objective.constraint));
  }
  const SolverRow& solver = *plan.solver;
  if (objective.epsilon && !solver.takes_epsilon) {
    return fail(ErrorCode::usage, "epsilon",
                std::string(solver.name) + " has no such bound; these solvers do: " +
                    names_of_solvers([](const SolverRow& row) { return row.takes_epsilon; }));
  }
  if (objective.huber && (!solver.minimises || objective.epsilon || plan.l1_reweighting > 0.0)) {
    return fail(ErrorCode::usage, "huber", "needs " + names_of_solvers([](const SolverRow& row) {
                                             return row.minimises;
                                           }) + ", and neither an epsilon nor a second pass for the l1 term");
  }
  if (plan.l1_reweighting > 0.0 && !(solver.reweights && objective.basis == BasisKind::identity)) {
    return fail(ErrorCode::usage, "l1 reweighting", "needs " + names_of_solvers([](const SolverRow& row) {
                                                      return row.reweights;
                                                    }) + " and the identity basis");
  }
  if (plan.warm_start && !solver.starts_warm()) {
    return fail(ErrorCode::usage, "warm start", "needs " + names_of_solvers([](const SolverRow& row) {
                                                  return row.starts_warm();
                                                }) + ": no other solver keeps anything from frame to frame");
  }
  if (solver.check != nullptr) return solver.check(objective, plan);
  return {};
}

}  // namespace

hal::Result<void> check_choice(const Objective& objective, const Plan& plan) {
  return check_objective(objective).and_then([&] { return check_plan(plan); }).and_then([&] {
    return check_pair(objective, plan);
  });
}

hal::Result<void> check_scale(double squares, int cols) {
  const double column = std::sqrt(squares / cols);
  if (column >= 1e-35 && column <= 1e35) return {};
  return fail(ErrorCode::out_of_range, "response",
              "has columns of norm " + number_text(column) +
                  " (root mean square), expected 1e-35 to 1e35: give A and y in another unit");
}

hal::Result<void> check_in_precision(double squares, const Objective& objective, const Plan& plan,
                                     const UnitChoice& unit) {
  const bool single = plan.precision == Precision::f32;
  const double most = single ? 1e35 : 1e300;
  if (std::ldexp(unit.squared(objective.lambda), unit.picture) > most)
    return out_of_range("lambda", objective.lambda, "a smaller number");
  if (objective.constraint == ConstraintKind::box && std::max(std::abs(objective.lo), std::abs(objective.hi)) > 1e37) {
    return fail(ErrorCode::out_of_range, "box",
                "is [" + number_text(objective.lo) + ", " + number_text(objective.hi) +
                    "], expected bounds of at most 1e37 in magnitude");
  }
  const double rounding = single ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
  const double least_rho = squares * rounding * rounding, most_rho = squares / rounding;
  if (plan.rho >= least_rho && plan.rho <= most_rho) return {};
  return fail(ErrorCode::out_of_range, plan.solver->rho == RhoUse::lambda ? "lambda" : "rho",
              "is " + number_text(plan.rho) + ", expected " + number_text(least_rho) + " to " + number_text(most_rho) +
                  " for this response: beyond that, rounding decides the picture");
}

}  // namespace compueye::recon
