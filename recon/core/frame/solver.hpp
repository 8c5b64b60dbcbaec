#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// A method of the frame path. `problem` is the struct of the method's own that is derived from FrameProblem.
template <class T>
struct Solver {
  /// Bytes of workspace that solve() uses, exactly.
  std::size_t (*bytes)(const FrameProblem<T>& problem) noexcept;
  /// One frame: `y` and `weights` have problem.channels entries (weights null: all one), `workspace` has bytes() and is
  /// aligned to Workspace::alignment, x has problem.pixels(). Exactly problem.point.iterations iterations, unless the
  /// method says otherwise; the x handed out satisfies the constraint exactly.
  FrameInfo (*solve)(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                     float* x) noexcept;
  /// Makes the next frame in this workspace start cold; null where every frame does.
  void (*forget)(std::byte* workspace) noexcept;
};

}  // namespace compueye::recon::core
