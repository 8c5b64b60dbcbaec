#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// Over-relaxed ADMM with a cached inverse (Boyd et al. 2011, "Distributed optimization and statistical learning via
/// the alternating direction method of multipliers", sections 3.1.1, 3.4.3 and 4.2.4). x is split from one copy of
/// itself for each term that has a simple proximal map: one copy when the l1 term and the constraint act on the same
/// variable (their joint map is a soft threshold followed by a clip), two (coefficients and pixels) when an orthonormal
/// basis meets a constraint, because composing those two maps is not the map of their sum.
///
/// In pixels, a frame of a small eye whose weights are all one takes problem.thin_step, a tenth of the time.
///
/// Exactly problem.point.iterations iterations. Converged by Boyd et al.'s criterion (section 3.3.1), with both
/// residuals relative: judged so, a rho that is far too small or too large never looks converged. The returned x
/// satisfies the constraint exactly. With problem.l1_reweighting (identity basis) as many iterations again, with
/// weights from the first pass, see Plan; the objective is then the weighted one, and there is no duality gap. `y` and
/// `weights` have problem.channels entries (weights null: all one), x has problem.pixels().
template <class T>
FrameInfo solve_admm(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                     float* x) noexcept;

/// Bytes of workspace that solve_admm() uses, exactly.
template <class T>
[[nodiscard]] std::size_t admm_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
