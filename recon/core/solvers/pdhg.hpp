#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/parts/deflated_step.hpp"
#include "recon/core/parts/penalty_schedule.hpp"

namespace compueye::recon::core {

/// The primal-dual hybrid gradient method (Chambolle & Pock 2011, algorithm 1; over-relaxed as Condat 2013, algorithm
/// 3.1) in a dual metric that treats the leading modes of A exactly (core/deflated_step.hpp) and all others by one
/// step. A few modes whose singular values stand far above the rest are what makes the plain method crawl; without them
/// tens of iterations do what thousands did.
///
///   g = A'u + Psi'q;  p = prox(x - tau g);  x' = 2 p - x;  x += theta (p - x)
///   u -= theta F (u - (A x' - y));  q += theta (clip(q + sigma Psi x', +-lambda) - q)
///
/// tau = 1 / problem.rho, sigma = w / (tau ||Psi||^2). In pixels the l1 term joins the constraint's map and there is no
/// q. Weights that are not one change F alone, by Woodbury's identity as in core/weighted_step.hpp: the metric stays
/// valid whatever is missing.
///
/// With problem.warm_start the workspace keeps x, u and q from frame to frame, and a frame goes on from them unless its
/// samples have changed too much (core/warm_start.hpp). Exactly problem.point.iterations iterations; the x handed out
/// satisfies the constraint exactly. Health by the duality gap where it is measured, else by the last steps of x and u.
template <class T>
struct PdhgProblem : FrameProblem<T> {
  static constexpr std::string_view method = "pdhg";
  static const Solver<T> solver;

  T rho = T(1);                 ///< 1 / tau
  PenaltySchedule<T> schedule;  ///< of rho
  T relaxation = T(1);
  T basis_step = T(0);
  DeflatedStep<T> dual_step;
  bool warm_start = false;  ///< frames go on from the last one

  template <class Archive>
  void fields(Archive& archive) {
    archive.number(rho);
    describe(schedule, archive);
    archive.number(relaxation);
    archive.number(basis_step);
    describe(dual_step, archive);
    archive.number(warm_start);
  }
};

extern template struct PdhgProblem<float>;
extern template struct PdhgProblem<double>;

}  // namespace compueye::recon::core
