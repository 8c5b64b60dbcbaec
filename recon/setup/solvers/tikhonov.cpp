#include "recon/core/solvers/tikhonov.hpp"

#include "recon/setup/inverse_tables.hpp"
#include "recon/setup/solver_row_of.hpp"

namespace compueye::recon {
namespace {

hal::Result<void> check(const Objective& objective, const Plan&) {
  if (objective.lambda > 0.0) return {};
  return hal::fail(hal::ErrorCode::usage, "tikhonov", "needs a lambda above 0 (it is the weight of ||x||^2)");
}

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    return TRY(begin_factored<core::TikhonovProblem<T>>(from, classes_of(from)));
  }
};

}  // namespace

extern const SolverRow tikhonov;  // for recon/solver_list.cpp
constinit const SolverRow tikhonov = solver_row_of<core::TikhonovProblem, Method>({.factor = FactorUse::inverse,
                                                                                   .rho = RhoUse::lambda,
                                                                                   .lambda = LambdaUse::variances,
                                                                                   .minimises = false,
                                                                                   .direct = true,
                                                                                   .takes = pixels_without_constraint,
                                                                                   .check = check});

}  // namespace compueye::recon
