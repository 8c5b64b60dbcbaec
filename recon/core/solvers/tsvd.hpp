#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// Truncated singular value decomposition (Hansen 1998, "Rank-deficient and discrete ill-posed problems", section 3.2):
/// x = A' U S^-2 d over the `rank` leading singular pairs of A, with d = U'y; a linear answer, in pixels, without
/// iterations. With weights d minimises ||W^(1/2)(U d - y)||, which is what a fit within those pairs then means: with
/// D = I - W on the reweighted channels and P = U U', a channel's sample becomes w y + (1 - w) f, where f solves
/// (D^-1 - P) D f = P W y on those channels. Where they leave d open, the shortest d is meant.
///
/// The objective is 1/2 ||W^(1/2)(A x - y)||^2.
template <class T>
FrameInfo solve_tsvd(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                     float* x) noexcept;

/// Bytes of workspace that solve_tsvd() uses, exactly.
template <class T>
[[nodiscard]] std::size_t tsvd_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
