#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// The primal-dual method of Chambolle & Pock (2011, algorithm 1, theta = 1) with the diagonal steps of Pock &
/// Chambolle (2011, "Diagonal preconditioning for first order primal-dual algorithms", lemma 2, alpha = 1) on the rows
/// and columns of A, and one step for the basis. Duals for A x and for Psi x, a projection for the constraint: every
/// basis meets every constraint, and no factor is needed.
///
/// Over-relaxed by problem.relaxation (Condat 2013, algorithm 3.1), which saves about two iterations of five. Health by
/// the duality gap.
///
/// Steps from problem.primal_steps, dual_steps and basis_step (recon/setup/step_sizes.hpp); exactly
/// problem.point.iterations iterations; the returned x satisfies the constraint exactly.
template <class T>
struct ChambollePockProblem : FrameProblem<T> {
  static constexpr std::string_view method = "cp";
  static const Solver<T> solver;

  const T* primal_steps = nullptr;  ///< a.cols of them (recon/setup/step_sizes.hpp)
  const T* dual_steps = nullptr;    ///< a.rows of them
  T basis_step = T(0);
  T relaxation = T(1);

  template <class Archive>
  void fields(Archive& archive) {
    archive.table(primal_steps, this->a.cols);
    archive.table(dual_steps, this->a.rows);
    archive.number(basis_step);
    archive.number(relaxation);
  }
};

extern template struct ChambollePockProblem<float>;
extern template struct ChambollePockProblem<double>;

}  // namespace compueye::recon::core
