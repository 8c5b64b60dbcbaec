#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;

namespace {

/// The bases that a solver takes with a constraint.
std::string bases_of(recon::SolverKind solver, recon::ConstraintKind constraint) {
  std::string bases;
  std::size_t taken = 0;
  for (const auto& basis : recon::basis_names()) {
    if (!recon::supports(solver, basis.kind, constraint)) continue;
    bases += (bases.empty() ? "" : ", ") + std::string(basis.name);
    ++taken;
  }
  if (taken == recon::basis_names().size()) return "every basis";
  return taken == 0 ? "-" : bases;
}

std::string what_goes_with_what() {
  std::string head = "| solver |", rule = "|---|", rows;
  for (const auto& constraint : recon::constraint_names()) {
    head += ' ' + std::string(constraint.name) + " |";
    rule += "---|";
  }
  for (const auto& solver : recon::solver_names()) {
    rows += "| `" + std::string(solver.name) + "` |";
    for (const auto& constraint : recon::constraint_names())
      rows += ' ' + bases_of(solver.kind, constraint.kind) + " |";
    rows += '\n';
  }
  return head + '\n' + rule + '\n' + rows;
}

}  // namespace

TEST_CASE("docs/solvers.md has the table of what goes with what") {
  const std::string page = test::bytes_of(test::source_path("docs/solvers.md"));
  const std::string wanted = what_goes_with_what();
  CHECK_MESSAGE(page.find("\n" + wanted) != std::string::npos, "docs/solvers.md must contain\n" << wanted);
}
