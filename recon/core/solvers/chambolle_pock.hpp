#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// The primal-dual method of Chambolle & Pock (2011, algorithm 1, theta = 1) with the diagonal steps of Pock &
/// Chambolle (2011, "Diagonal preconditioning for first order primal-dual algorithms", lemma 2, alpha = 1) on the rows
/// and columns of A, and one step for the basis. Duals for A x and for Psi x, a projection for the constraint: every
/// basis meets every constraint, and no factor is needed.
///
/// Over-relaxed by problem.relaxation (Condat 2013, algorithm 3.1), which saves about two iterations of five. Health by
/// the duality gap.
///
/// Steps from problem.primal_steps, dual_steps and basis_step (recon/setup/step_sizes.hpp); exactly
/// problem.point.iterations iterations; the returned x satisfies the constraint exactly.
template <class T>
FrameInfo solve_chambolle_pock(const FrameProblem<T>& problem, const float* y, const float* weights,
                               std::byte* workspace, float* x) noexcept;

/// Bytes of workspace that solve_chambolle_pock() uses, exactly.
template <class T>
[[nodiscard]] std::size_t chambolle_pock_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
