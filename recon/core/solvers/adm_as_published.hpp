#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// The dual alternating direction method as YALL1 v1.4 (Zhang, Yang & Yin 2011) runs it on rows that are not
/// orthonormal, faults included, so that they can be shown: it starts at x = A'y, takes one steepest descent step for
/// the dual variable, and stops when x moves by less than 1e-4 of itself, or when gap and dual residual are that small.
/// With receptive fields that overlap, A'y is orders of magnitude too large and the first thing that stands still is
/// not the solution. An epsilon it looks at only to stop, never in a step: without lambda it solves A x = y. For
/// comparisons only; core/adm.hpp is the method to use.
///
/// At most problem.point.iterations iterations. Health is what the original claims: converged when it stopped by
/// itself. Takes pixels with x >= 0 or no constraint, or an orthonormal basis with none.
template <class T>
struct PublishedAdmProblem : FrameProblem<T> {
  static constexpr std::string_view method = "adm as published";
  static const Solver<T> solver;

  template <class Archive>
  void fields(Archive&) {}
};

extern template struct PublishedAdmProblem<float>;
extern template struct PublishedAdmProblem<double>;

}  // namespace compueye::recon::core
