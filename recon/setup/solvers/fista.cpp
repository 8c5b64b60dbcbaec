#include "recon/core/solvers/fista.hpp"

#include "recon/setup/solver_row_of.hpp"
#include "recon/setup/step_sizes.hpp"

namespace compueye::recon {
namespace {

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    auto problem = TRY(begin_problem<core::FistaProblem<T>>(from));
    problem->lipschitz = static_cast<T>(squared_norm_bound(from.seeing));
    return problem;
  }
};

}  // namespace

extern const SolverRow fista;  // for recon/solver_list.cpp
constinit const SolverRow fista = solver_row_of<core::FistaProblem, Method>({.takes = one_proximal_map});

}  // namespace compueye::recon
