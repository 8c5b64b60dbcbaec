#include "studies/comparison/contenders.hpp"

#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_table.hpp"
#include "studies/named_kinds.hpp"

namespace compueye::firmware {

hal::Result<std::vector<Contender>> contenders(const CompareOptions& options, recon::ConstraintKind of_board) {
  const auto solvers = TRY(kinds_of("--solvers", options.solvers, recon::solver_names()));
  const auto bases = TRY(kinds_of("--bases", options.bases, recon::basis_names()));
  recon::ConstraintKind wanted = of_board;
  if (!options.constraint.empty()) {
    wanted = TRY(kinds_of("--constraint", {options.constraint}, recon::constraint_names())).front();
  }
  std::vector<Contender> all;
  for (const recon::BasisKind basis : bases) {
    for (const recon::SolverKind solver : solvers) {
      for (const recon::ConstraintKind constraint : {wanted, recon::ConstraintKind::none}) {
        if (!recon::supports(solver, basis, constraint)) continue;
        all.push_back({solver, basis, constraint});
        break;
      }
    }
  }
  if (!all.empty()) return all;
  return hal::fail(hal::ErrorCode::usage, "--solvers",
                   "and --bases leave nothing to compare; `compueye reconstruct --help` says what goes with what");
}

}  // namespace compueye::firmware
