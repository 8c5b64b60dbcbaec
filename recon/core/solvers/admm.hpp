#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/parts/penalty_schedule.hpp"
#include "recon/core/parts/thin_step.hpp"

namespace compueye::recon::core {

/// Over-relaxed ADMM with a cached inverse (Boyd et al. 2011, "Distributed optimization and statistical learning via
/// the alternating direction method of multipliers", sections 3.1.1, 3.4.3 and 4.2.4). x is split from one copy of
/// itself for each term that has a simple proximal map: one copy when the l1 term and the constraint act on the same
/// variable (their joint map is a soft threshold followed by a clip), two (coefficients and pixels) when an orthonormal
/// basis meets a constraint, because composing those two maps is not the map of their sum.
///
/// In pixels, a frame of a small eye whose weights are all one takes problem.thin_step, a tenth of the time.
///
/// Exactly problem.point.iterations iterations. Converged by Boyd et al.'s criterion (section 3.3.1), with both
/// residuals relative: judged so, a rho that is far too small or too large never looks converged. The returned x
/// satisfies the constraint exactly. With problem.l1_reweighting (identity basis) as many iterations again, with
/// weights from the first pass, see Plan; the objective is then the weighted one, and there is no duality gap. `y` and
/// `weights` have problem.channels entries (weights null: all one), x has problem.pixels().
template <class T>
struct AdmmProblem : FactoredProblem<T> {
  static constexpr std::string_view method = "admm";
  static const Solver<T> solver;

  ThinStep<T> thin_step;        ///< in pixels, of a small eye
  PenaltySchedule<T> schedule;  ///< with a thin step
  T relaxation = T(1);
  T l1_reweighting = T(0);  ///< in pixels: e of the second pass's weights 2e / (|x| + e); 0: one pass

  template <class Archive>
  void fields(Archive& archive) {
    FactoredProblem<T>::fields(archive);
    describe(thin_step, archive);
    describe(schedule, archive);
    archive.number(relaxation);
    archive.number(l1_reweighting);
  }
};

extern template struct AdmmProblem<float>;
extern template struct AdmmProblem<double>;

}  // namespace compueye::recon::core
