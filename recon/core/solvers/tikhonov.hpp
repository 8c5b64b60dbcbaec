#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// The minimiser of 1/2 ||W^(1/2)(A x - y)||^2 + lambda/2 ||x||^2, directly (Tikhonov 1963; with Gaussian noise and a
/// Gaussian prior of variance s^2 it is the posterior mean for lambda = sigma^2 / s^2). problem.rho must equal
/// problem.lambda; basis and constraint are not used.
template <class T>
FrameInfo solve_tikhonov(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                         float* x) noexcept;

/// Bytes of workspace that solve_tikhonov() uses, exactly.
template <class T>
[[nodiscard]] std::size_t tikhonov_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
