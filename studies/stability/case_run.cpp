#include "studies/stability/case_run.hpp"

#include <algorithm>

#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/solver_list.hpp"

namespace compueye::firmware {

hal::Result<CaseFrame> run_case(const HardProblem& problem, const recon::Objective& objective, const CaseWay& way) {
  recon::Plan plan;
  plan.solver = way.solver;
  plan.precision = way.precision;
  plan.iterations = way.iterations;
  plan.measure_gap = true;
  plan.max_reweighted = static_cast<int>(
      std::count_if(problem.weights.begin(), problem.weights.end(), [](float w) { return w != 1.0F; }));
  const recon::Reconstructor solver = TRY(recon::Reconstructor::create(problem.a, objective, plan));
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  CaseFrame frame;
  frame.x.resize(static_cast<std::size_t>(solver.pixels()));
  frame.info = solver.solve(problem.y, problem.weights, workspace.span(), frame.x);
  return frame;
}

recon::Objective with_lambda(const recon::Objective& objective, const HardCase& hard, const HardProblem& problem,
                             recon::SolverKind solver) {
  recon::Objective with = objective;
  with.lambda =
      hard.lambda_share * (solver->direct ? problem.a.squared_norm() : lambda_of_zero(problem, objective.basis));
  return with;
}

}  // namespace compueye::firmware
