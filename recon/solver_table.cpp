#include "recon/solver_table.hpp"

#include "recon/option_names.hpp"

namespace compueye::recon {

bool supports(SolverKind solver, BasisKind basis, ConstraintKind constraint) noexcept {
  const bool pixels = basis == BasisKind::identity, orthonormal = basis != BasisKind::tv;
  const bool unconstrained = constraint == ConstraintKind::none;
  switch (solver) {
    case SolverKind::admm:
    case SolverKind::chambolle_pock:
    case SolverKind::pdhg:
      return true;
    case SolverKind::fista:
    case SolverKind::adm:
      return pixels || (orthonormal && unconstrained);
    case SolverKind::adm_as_published:
      return (pixels && constraint != ConstraintKind::box) || (orthonormal && unconstrained);
    case SolverKind::omp:
      return orthonormal && unconstrained;
    case SolverKind::tikhonov:
    case SolverKind::tsvd:
      return pixels && unconstrained;
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
