#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// The dual alternating direction method of Yang & Zhang (2011, "Alternating direction algorithms for l1-problems in
/// compressive sensing", section 2.2), which is what Lee et al. (2016) solve with, made exact for rows that are not
/// orthonormal: they solve for the dual variable of A x = y in closed form when A A' = I and take one steepest descent
/// step otherwise (core/adm_as_published.hpp); here the cached (A A' + rho I)^-1 solves it for every A and every W. The
/// penalty of their augmented Lagrangian is 1 / rho, the step of the multiplier, which is x, 1.618.
///
/// With problem.bounded it solves min ||Psi x||_1 subject to ||W^(1/2)(A x - y)|| <= epsilon. Their closed form for
/// that, too, holds for A A' = I only; here the residual is a second multiplier with a proximal map of its own
/// (core/residual_copy.hpp), so that the bound holds for every A. The same second multiplier serves a lambda so small
/// that the iteration would crawl with the one factor there is: both penalties then follow the size of y.
///
/// Takes pixels with any constraint, or an orthonormal basis with none. Exactly problem.point.iterations iterations;
/// converged when x, its sparse copy (which is returned) and their change agree to 1e-3, and the bound holds to 1e-3.
template <class T>
struct AdmProblem : FactoredProblem<T> {
  static constexpr std::string_view method = "adm";
  static const Solver<T> solver;

  T mean_row_sum = T(1);  ///< of the magnitudes of A's entries
  T column_norm = T(1);   ///< root mean square norm of A's columns

  template <class Archive>
  void fields(Archive& archive) {
    FactoredProblem<T>::fields(archive);
    archive.number(mean_row_sum);
    archive.number(column_norm);
  }
};

extern template struct AdmProblem<float>;
extern template struct AdmProblem<double>;

}  // namespace compueye::recon::core
