#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/bases/basis.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/core/parts/class_inverse.hpp"
#include "recon/core/parts/crew.hpp"
#include "recon/core/parts/deflated_step.hpp"
#include "recon/core/parts/frame_info.hpp"
#include "recon/core/parts/metric.hpp"
#include "recon/core/parts/penalty_schedule.hpp"
#include "recon/core/parts/thin_step.hpp"

namespace compueye::recon::core {

/// Leading singular pairs of A: its left singular vectors and the inverse squares of its singular values.
template <class T>
struct SingularModes {
  std::size_t rank = 0;
  const T* left = nullptr;             ///< a.rows x rank, row-major
  const T* inverse_squares = nullptr;  ///< rank
};

/// Everything a frame is solved with, set up once and only read afterwards: views of tables owned by the caller
/// (recon::Reconstructor on a computer with a heap, constant arrays on a microcontroller).
///
///   min 1/2 ||W^(1/2)(A x - y)||^2 + lambda ||Psi x||_1   subject to lo <= x <= hi
template <class T>
struct FrameProblem {
  LinearOperator<T> a;                   ///< seeing rows only
  ClassInverse<T> inverse;               ///< (A K0^-1 A' + rho I)^-1, order = a.rows
  ThinStep<T> thin_step;                 ///< for admm in pixels
  const std::int32_t* seeing = nullptr;  ///< a.rows channel numbers, ascending
  std::size_t channels = 0;              ///< M: length of y and of the weights
  std::size_t max_reweighted = 0;        ///< how many weights may differ from one in a frame
  std::size_t image_rows = 0;
  std::size_t image_cols = 0;  ///< image_rows * image_cols = a.cols
  Basis<T> psi;
  Metric<T> metric;  ///< K0; the identity unless psi is tv
  bool constrained = false;
  T lo = T(0);  ///< -infinity where there is no bound
  T hi = T(0);  ///< +infinity where there is no bound
  T lambda = T(0);
  T rho = T(1);
  PenaltySchedule<T> schedule;  ///< for pdhg, and admm with a thin step
  T relaxation = T(1);
  T l1_reweighting = T(0);          ///< admm in pixels: e of the second pass's weights 2e / (|x| + e); 0: one pass
  T lipschitz = T(1);               ///< at least ||A||_2^2, for fista
  const T* primal_steps = nullptr;  ///< a.cols of them, for cp (recon/setup/step_sizes.hpp)
  const T* dual_steps = nullptr;    ///< a.rows of them, for cp
  T basis_step = T(0);              ///< for cp and pdhg
  DeflatedStep<T> dual_step;        ///< for pdhg
  bool bounded = false;             ///< adm: min ||Psi x||_1 subject to ||W^(1/2)(A x - y)|| <= epsilon instead
  T epsilon = T(0);
  T mean_row_sum = T(1);          ///< of the magnitudes of A's entries
  T column_norm = T(1);           ///< root mean square norm of A's columns
  const T* atom_norms = nullptr;  ///< a.cols norms ||A psi_j||, for omp
  SingularModes<T> modes;         ///< for tsvd
  bool measure_gap = false;
  bool warm_start = false;  ///< pdhg: frames go on from the last one
  OperatingPoint point;     ///< point.iterations = K
  Crew crew = {};           ///< for the passes over pixels and coefficients; operator, bases and inverse have theirs

  [[nodiscard]] std::size_t pixels() const noexcept { return a.cols; }

  /// Hands the same crew to everything that can share its work. Before any workspace is measured.
  void employ(const Crew& workers) noexcept {
    crew = a.crew = inverse.crew = dual_step.crew = psi.dct.crew = metric.dct.crew = workers;
  }
};

}  // namespace compueye::recon::core
