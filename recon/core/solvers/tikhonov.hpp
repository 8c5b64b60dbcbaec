#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// The minimiser of 1/2 ||W^(1/2)(A x - y)||^2 + lambda/2 ||x||^2, directly (Tikhonov 1963; with Gaussian noise and a
/// Gaussian prior of variance s^2 it is the posterior mean for lambda = sigma^2 / s^2). problem.rho must equal
/// problem.lambda; basis and constraint are not used.
template <class T>
struct TikhonovProblem : FactoredProblem<T> {
  static constexpr std::string_view method = "tikhonov";
  static const Solver<T> solver;
};

extern template struct TikhonovProblem<float>;
extern template struct TikhonovProblem<double>;

}  // namespace compueye::recon::core
