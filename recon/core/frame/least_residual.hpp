#pragma once

#include <cstddef>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

/// What no picture can explain of a frame's samples, whatever solver, penalty and number of iterations made `x`.
struct LeastResidual {
  double least = 0.0;    ///< >= 0: ||W^(1/2)(A p - y)|| is at least this for every p of the same range
  double samples = 0.0;  ///< ||W^(1/2) y||, of which rounding is a share
};

/// By weak duality of min 1/2 ||W^(1/2)(A p - y)||^2 over pictures p within [min(0, x), max(1, x)], with the residual
/// r of x for its direction: r'W (y - A p) <= ||r|| ||y - A p|| for every p, so that
///
///   least = (r'W y - sup_p p'A'W r) / ||W^(1/2) r||
///
/// It says nothing (0) of an x that is far from its optimum and never too much: samples of a picture in that range
/// with noise n give at most ||W^(1/2) n||. One A and one A'. `y`, `weights` and `x` as for Solver::solve().
template <class T>
[[nodiscard]] LeastResidual least_residual(const FrameProblem<T>& problem, const float* y, const float* weights,
                                           const float* x, std::byte* workspace) noexcept;
/// y - A x of every channel, of problem.channels: 0 where it is blind or weighs nothing. One A, in the same workspace.
template <class T>
void channel_residuals(const FrameProblem<T>& problem, const float* y, const float* weights, const float* x,
                       std::byte* workspace, float* residuals) noexcept;
/// Bytes of that workspace, exactly.
template <class T>
[[nodiscard]] std::size_t least_residual_bytes(const FrameProblem<T>& problem) noexcept;

}  // namespace compueye::recon::core
