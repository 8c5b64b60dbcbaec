#include "recon/core/solvers/omp.hpp"

#include "recon/setup/atom_norms.hpp"
#include "recon/setup/solver_row_of.hpp"

namespace compueye::recon {
namespace {

bool takes(BasisKind basis, ConstraintKind constraint) noexcept {
  return basis != BasisKind::tv && constraint == ConstraintKind::none;
}

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    auto problem = TRY(begin_problem<core::OmpProblem<T>>(from));
    const std::vector<double> norms = atom_norms(from.seeing, from.objective.basis);
    problem->atom_norms = from.kept.keep(std::vector<T>(norms.begin(), norms.end()));
    return problem;
  }
};

}  // namespace

extern const SolverRow omp;  // for recon/solver_list.cpp
constinit const SolverRow omp = solver_row_of<core::OmpProblem, Method>(
    {.lambda = LambdaUse::atoms, .minimises = false, .takes_epsilon = true, .takes = takes});

}  // namespace compueye::recon
