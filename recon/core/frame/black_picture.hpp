#pragma once

#include "recon/core/frame/frame_info.hpp"
#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frame_samples.hpp"

namespace compueye::recon::core {

/// What a method no longer needs once its picture is handed out.
template <class T>
struct SpareVectors {
  const FrameSamples<T>& samples;
  T* rows;          ///< problem.a.rows
  T* pixels;        ///< problem.pixels()
  T* coefficients;  ///< problem.psi.coefficients(); may be null in pixels
  T* scratch;       ///< problem.psi.scratch_size()
};

/// Hands out x = 0 in place of a picture whose objective is not below that of x = 0, where the constraint allows it:
/// as converged where x = 0 is the optimum, which is where
///
///   |Psi A'W y| <= lambda, or in pixels the constraint takes up the excess, or A'W y <= 0 and x >= 0,
///
/// because iterations come near zero but not to it; else as whatever the budget left, because it is nearer to the
/// optimum than the picture. Costs a pass over the samples, and one application of A' only where black comes into
/// question. Nothing is done to a frame with an epsilon, which is no sum of two terms.
template <class T>
void prefer_black(const FrameProblem<T>& problem, const SpareVectors<T>& spare, FrameInfo& info, float* x) noexcept;

}  // namespace compueye::recon::core
