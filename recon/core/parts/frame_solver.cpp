#include "recon/core/parts/frame_solver.hpp"

#include "recon/core/solvers/adm.hpp"
#include "recon/core/solvers/adm_as_published.hpp"
#include "recon/core/solvers/admm.hpp"
#include "recon/core/solvers/chambolle_pock.hpp"
#include "recon/core/solvers/fista.hpp"
#include "recon/core/solvers/omp.hpp"
#include "recon/core/solvers/pdhg.hpp"
#include "recon/core/solvers/tikhonov.hpp"
#include "recon/core/solvers/tsvd.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
FrameInfo solve_with(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                     float* x) noexcept {
  switch (problem.point.solver) {
    case SolverKind::admm:
      return solve_admm(problem, y, weights, workspace, x);
    case SolverKind::fista:
      return solve_fista(problem, y, weights, workspace, x);
    case SolverKind::chambolle_pock:
      return solve_chambolle_pock(problem, y, weights, workspace, x);
    case SolverKind::tikhonov:
      return solve_tikhonov(problem, y, weights, workspace, x);
    case SolverKind::adm:
      return solve_adm(problem, y, weights, workspace, x);
    case SolverKind::adm_as_published:
      return solve_adm_as_published(problem, y, weights, workspace, x);
    case SolverKind::omp:
      return solve_omp(problem, y, weights, workspace, x);
    case SolverKind::tsvd:
      return solve_tsvd(problem, y, weights, workspace, x);
    case SolverKind::pdhg:
      return solve_pdhg(problem, y, weights, workspace, x);
  }
  return {};
}

template <class T>
std::size_t bytes_for(const FrameProblem<T>& problem) noexcept {
  switch (problem.point.solver) {
    case SolverKind::admm:
      return admm_bytes(problem);
    case SolverKind::fista:
      return fista_bytes(problem);
    case SolverKind::chambolle_pock:
      return chambolle_pock_bytes(problem);
    case SolverKind::tikhonov:
      return tikhonov_bytes(problem);
    case SolverKind::adm:
      return adm_bytes(problem);
    case SolverKind::adm_as_published:
      return adm_as_published_bytes(problem);
    case SolverKind::omp:
      return omp_bytes(problem);
    case SolverKind::tsvd:
      return tsvd_bytes(problem);
    case SolverKind::pdhg:
      return pdhg_bytes(problem);
  }
  return 0;
}

}  // namespace

FrameInfo solve_frame(const FrameProblem<float>& problem, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept {
  return solve_with(problem, y, weights, workspace, x);
}
FrameInfo solve_frame(const FrameProblem<double>& problem, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept {
  return solve_with(problem, y, weights, workspace, x);
}
std::size_t workspace_bytes(const FrameProblem<float>& problem) noexcept {
  return bytes_for(problem);
}
std::size_t workspace_bytes(const FrameProblem<double>& problem) noexcept {
  return bytes_for(problem);
}

}  // namespace compueye::recon::core
