#pragma once

#include <cstddef>

#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// FISTA (Beck & Teboulle 2009, "A fast iterative shrinkage-thresholding algorithm", section 4) with adaptive restart
/// by the gradient scheme (O'Donoghue & Candes 2015, section 3.2). One proximal map must do for the l1 term and the
/// constraint together, so it takes pixels with any constraint, or an orthonormal basis with none.
///
/// Steps of 1 / problem.lipschitz; exactly problem.point.iterations iterations. Health by the duality gap.
template <class T>
FrameInfo solve_fista(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept;

/// Bytes of workspace that solve_fista() uses, exactly.
template <class T>
[[nodiscard]] std::size_t fista_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
