#include "recon/core/solvers/tsvd.hpp"

#include "recon/setup/singular_modes.hpp"
#include "recon/setup/solver_row_of.hpp"

namespace compueye::recon {
namespace {

hal::Result<void> check(const Objective& objective, const Plan& plan) {
  if (plan.rank > 0 || objective.lambda > 0.0) return {};
  return hal::fail(hal::ErrorCode::usage, "tsvd",
                   "needs a rank, or a lambda above 0 (the least square of a singular value)");
}

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    auto problem = TRY(begin_problem<core::TsvdProblem<T>>(from));
    const double least_square = from.plan.rank > 0 ? 0.0 : from.objective.lambda;
    const ModeTable found = TRY(singular_modes(from.seeing, from.plan.rank, least_square, from.progress));
    std::vector<T> weights;
    for (const double value : found.values) weights.push_back(static_cast<T>(1.0 / (value * value)));
    problem->modes = {found.values.size(), from.kept.keep(std::vector<T>(found.left.begin(), found.left.end())),
                      from.kept.keep(std::move(weights))};
    from.plan.rank = static_cast<int>(problem->modes.rank);
    return problem;
  }
};

}  // namespace

extern const SolverRow tsvd;  // for recon/solver_list.cpp
constinit const SolverRow tsvd = solver_row_of<core::TsvdProblem, Method>({.rank = RankUse::singular_values,
                                                                           .lambda = LambdaUse::variances,
                                                                           .minimises = false,
                                                                           .direct = true,
                                                                           .takes = pixels_without_constraint,
                                                                           .check = check});

}  // namespace compueye::recon
