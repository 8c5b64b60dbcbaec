#include "recon/core/solvers/adm_as_published.hpp"

#include "recon/setup/solver_row_of.hpp"

namespace compueye::recon {
namespace {

bool takes(BasisKind basis, ConstraintKind constraint) noexcept {
  return one_proximal_map(basis, constraint) && constraint != ConstraintKind::box;
}

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    return TRY(begin_problem<core::PublishedAdmProblem<T>>(from));
  }
};

}  // namespace

extern const SolverRow adm_as_published;  // for adm.cpp
constinit const SolverRow adm_as_published =
    solver_row_of<core::PublishedAdmProblem, Method>({.takes_epsilon = true, .takes = takes});

}  // namespace compueye::recon
