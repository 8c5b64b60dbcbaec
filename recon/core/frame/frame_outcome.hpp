#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"

namespace compueye::recon::core {

/// Hands out x; or all zeros with Health::invalid and figures of 0 when `usable` is false, or the solution (as float32)
/// or its objective is not finite. Comes last, after evaluate().
template <class T>
void deliver(const T* solution, bool usable, std::size_t n, FrameInfo& info, float* x) noexcept;

/// Fills in the residual, the channel counts and the objective with the given penalty term; `scratch` takes
/// problem.a.rows values.
template <class T>
void evaluate(const FrameSamples<T>& samples, const T* solution, double penalty, T* scratch, FrameInfo& info) noexcept;

/// lambda ||c||_1 of psi.coefficients() coefficients.
template <class T>
[[nodiscard]] double l1_penalty(const FrameProblem<T>& problem, const T* coefficients) noexcept;

/// Health of a first-order method, whose steps grow small long before the end where A is ill-conditioned: converged
/// when the gap is at most 1e-3 of the objective, which is then several times closer to its optimum; where there is no
/// gap (negative), when the larger residual, the last step, was below 1e-6. The gap is told where it was asked for.
template <class T>
void judge_by_gap(const FrameProblem<T>& problem, double gap, FrameInfo& info) noexcept;

}  // namespace compueye::recon::core
