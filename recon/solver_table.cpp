#include "recon/solver_table.hpp"

#include "recon/option_names.hpp"

namespace compueye::recon {

bool supports(SolverKind solver, BasisKind basis, ConstraintKind constraint) noexcept {
  const bool unconstrained = constraint == ConstraintKind::none;
  switch (solver) {
    case SolverKind::admm:
    case SolverKind::chambolle_pock:
      return true;
    case SolverKind::fista:
      return basis == BasisKind::identity || (unconstrained && basis != BasisKind::tv);
    case SolverKind::tikhonov:
      return basis == BasisKind::identity && unconstrained;
  }
  return false;
}

std::string solvers_for(BasisKind basis, ConstraintKind constraint) {
  std::string names;
  for (const Named<SolverKind>& solver : solver_names()) {
    if (!supports(solver.kind, basis, constraint)) continue;
    if (!names.empty()) names += ", ";
    names += solver.name;
  }
  return names;
}

}  // namespace compueye::recon
