#include "recon/core/solvers/chambolle_pock.hpp"

#include "recon/setup/solver_row_of.hpp"
#include "recon/setup/step_sizes.hpp"

namespace compueye::recon {
namespace {

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    auto problem = TRY(begin_problem<core::ChambollePockProblem<T>>(from));
    const PrimalDualSteps steps = primal_dual_steps(from.seeing, problem->psi.squared_norm());
    problem->primal_steps = from.kept.keep(std::vector<T>(steps.primal.begin(), steps.primal.end()));
    problem->dual_steps = from.kept.keep(std::vector<T>(steps.dual.begin(), steps.dual.end()));
    problem->basis_step = static_cast<T>(steps.basis);
    problem->relaxation = static_cast<T>(from.plan.relaxation);
    return problem;
  }
};

}  // namespace

extern const SolverRow chambolle_pock;  // for recon/solver_list.cpp
constinit const SolverRow chambolle_pock =
    solver_row_of<core::ChambollePockProblem, Method>({.relaxes = true, .takes = any_pair});

}  // namespace compueye::recon
