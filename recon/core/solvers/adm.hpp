#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// The dual alternating direction method of Yang & Zhang (2011, "Alternating direction algorithms for l1-problems in
/// compressive sensing", section 2.2), which is what Lee et al. (2016) solve with, made exact for rows that are not
/// orthonormal: they solve for the dual variable of A x = y in closed form when A A' = I and take one steepest descent
/// step otherwise (core/adm_as_published.hpp); here the cached (A A' + rho I)^-1 solves it for every A and every W. The
/// penalty of their augmented Lagrangian is 1 / rho, the step of the multiplier, which is x, 1.618.
///
/// With problem.bounded it solves min ||Psi x||_1 subject to ||W^(1/2)(A x - y)|| <= epsilon. Their closed form for
/// that, too, holds for A A' = I only; here the residual is a second multiplier with a proximal map of its own
/// (core/residual_copy.hpp), so that the bound holds for every A. The same second multiplier serves a lambda so small
/// that the iteration would crawl with the one factor there is: both penalties then follow the size of y.
///
/// Takes pixels with any constraint, or an orthonormal basis with none. Exactly problem.point.iterations iterations;
/// converged when x, its sparse copy (which is returned) and their change agree to 1e-3, and the bound holds to 1e-3.
template <class T>
FrameInfo solve_adm(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                    float* x) noexcept;

/// Bytes of workspace that solve_adm() uses, exactly.
template <class T>
[[nodiscard]] std::size_t adm_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
