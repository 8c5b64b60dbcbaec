#pragma once

#include <cstddef>

#include "recon/core/parts/frame_problem.hpp"
#include "recon/core/parts/frame_samples.hpp"

namespace compueye::recon::core {

/// What is known of a frame before it is solved: the operating point, nothing done yet.
template <class T>
[[nodiscard]] FrameInfo begin_outcome(const FrameProblem<T>& problem) noexcept;

/// Hands out x; or all zeros with Health::invalid and figures of 0 when `usable` is false, or the solution (as float32)
/// or its objective is not finite. Comes last, after evaluate().
template <class T>
void deliver(const T* solution, bool usable, std::size_t n, FrameInfo& info, float* x) noexcept;

/// Fills in the residual, the channel counts and the objective with the given penalty term; `scratch` takes
/// problem.a.rows values.
template <class T>
void evaluate(const FrameSamples<T>& samples, const T* solution, double penalty, T* scratch, FrameInfo& info) noexcept;

}  // namespace compueye::recon::core
