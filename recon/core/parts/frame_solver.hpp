#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// One frame with the solver that problem.point names. `y` and `weights` have problem.channels entries (weights null:
/// all one), `workspace` has workspace_bytes() and is aligned to Workspace::alignment, x has problem.pixels().
FrameInfo solve_frame(const FrameProblem<float>& problem, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept;
FrameInfo solve_frame(const FrameProblem<double>& problem, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept;

/// Bytes of workspace that solve_frame() uses, exactly.
[[nodiscard]] std::size_t workspace_bytes(const FrameProblem<float>& problem) noexcept;
[[nodiscard]] std::size_t workspace_bytes(const FrameProblem<double>& problem) noexcept;

}  // namespace compueye::recon::core
