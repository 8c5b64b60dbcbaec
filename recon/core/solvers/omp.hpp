#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// Orthogonal matching pursuit (Pati, Rezaiifar & Krishnaprasad 1993): the l0 way of looking for a sparse x, to be
/// compared with. Takes the element of the basis whose atom A psi_j points most along the residual, fits all taken ones
/// by weighted least squares, and goes on until no atom's correlation with the residual exceeds lambda (the bound that
/// holds at the l1 optimum; Cai & Wang 2011, section III), until the residual is at most problem.epsilon, or until
/// problem.point.iterations elements are taken, or as many as A has rows or columns. Identity or an orthonormal basis,
/// no constraint.
///
/// The objective is 1/2 ||W^(1/2)(A x - y)||^2 alone, iterations is the number of elements; converged when it stopped
/// by lambda or epsilon. An element that depends on those taken, to a millionth of its norm, is passed over.
template <class T>
struct OmpProblem : FrameProblem<T> {
  static constexpr std::string_view method = "omp";
  static const Solver<T> solver;

  const T* atom_norms = nullptr;  ///< a.cols norms ||A psi_j||

  template <class Archive>
  void fields(Archive& archive) {
    archive.table(atom_norms, this->a.cols);
  }
};

extern template struct OmpProblem<float>;
extern template struct OmpProblem<double>;

}  // namespace compueye::recon::core
