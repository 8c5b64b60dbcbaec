#include "recon/solver_list.hpp"

#include <array>
#include <vector>

namespace compueye::recon {

// Each is defined by its file in recon/setup/solvers.
extern const SolverRow admm, adm, chambolle_pock, fista, omp, pdhg, tikhonov, tsvd;

namespace {

constexpr std::array<SolverKind, 8> to_choose{&admm, &adm, &chambolle_pock, &fista, &omp, &pdhg, &tikhonov, &tsvd};

}  // namespace

std::span<const SolverKind> solvers() noexcept {
  return to_choose;
}

SolverKind default_solver() noexcept {
  return to_choose.front();
}

SolverKind solver_named(std::string_view name) noexcept {
  for (const SolverKind solver : to_choose) {
    if (solver->name == name) return solver;
    if (solver->published != nullptr && solver->published->name == name) return solver->published;
  }
  return nullptr;
}

bool supports(SolverKind solver, BasisKind basis, ConstraintKind constraint) noexcept {
  return solver->takes(basis, constraint);
}

std::string names_of_solvers(const std::function<bool(const SolverRow&)>& wanted, std::string_view last) {
  std::vector<std::string_view> names;
  for (const SolverKind solver : solvers()) {
    if (wanted(*solver)) names.push_back(solver->name);
  }
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k > 0) text += k + 1 < names.size() ? ", " : last;
    text += names[k];
  }
  return text;
}

std::string solvers_for(BasisKind basis, ConstraintKind constraint) {
  return names_of_solvers([&](const SolverRow& row) { return row.takes(basis, constraint); });
}

}  // namespace compueye::recon
