#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/bases/basis.hpp"
#include "recon/core/frame/frame_info.hpp"
#include "recon/core/frame/frame_unit.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/core/parts/class_inverse.hpp"
#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// What stands for a bound that is not there: far beyond any picture, and its products stay within float32.
inline constexpr double no_bound = 1e30;

/// What a frame is solved with, set up once and only read afterwards: views of tables owned by the caller
/// (recon::Reconstructor on a computer with a heap, constant arrays on a microcontroller).
///
///   min 1/2 ||W^(1/2)(A x - y)||^2 + lambda ||Psi x||_1   subject to lo <= x <= hi
///
/// A method adds its own parameters in a struct derived from this, beside its solver (core/solvers/). Such a struct has
/// the name of its method, and fields(archive), which lists what it adds (core/frame/frozen_layout.hpp).
template <class T>
struct FrameProblem {
  LinearOperator<T> a;                   ///< seeing rows only
  const std::int32_t* seeing = nullptr;  ///< a.rows channel numbers, ascending
  std::size_t channels = 0;              ///< M: length of y and of the weights
  std::size_t max_reweighted = 0;        ///< how many weights may differ from one in a frame
  std::size_t image_rows = 0;
  std::size_t image_cols = 0;  ///< image_rows * image_cols = a.cols
  Basis<T> psi;
  Metric<T> metric;          ///< K0; the identity unless psi is tv
  bool constrained = false;  ///< there is a lo or a hi
  T lo = T(-no_bound);
  T hi = T(no_bound);
  T lambda = T(0);
  bool bounded = false;  ///< min ||Psi x||_1 subject to ||W^(1/2)(A x - y)|| <= epsilon instead
  T epsilon = T(0);
  FrameUnit unit;            ///< A, lambda, lo, hi and epsilon are in it
  bool homogeneous = false;  ///< c y gives c x, c > 0, so that a frame may be solved in a unit of its own
  bool measure_gap = false;
  OperatingPoint point;  ///< point.iterations = K
  Crew crew = {};        ///< for the passes over pixels and coefficients; operator, bases and inverse have theirs

  [[nodiscard]] std::size_t pixels() const noexcept { return a.cols; }
};

/// Of the methods whose quadratic step has a cached inverse (core/frame/weighted_step.hpp).
template <class T>
struct FactoredProblem : FrameProblem<T> {
  ClassInverse<T> inverse;  ///< (A K0^-1 A' + rho I)^-1, order = a.rows
  /// Of a tall A in place of it (core/frame/pixel_step.hpp): A'A + rho K0 and its inverse, order = a.cols; else 0. The
  /// former is there only where a weight may differ from one.
  PackedSymmetric<double> pixel_inverse, pixel_matrix;
  T rho = T(1);

  template <class Archive>
  void fields(Archive& archive) {
    describe(inverse, archive);
    describe(pixel_inverse, archive);
    describe(pixel_matrix, archive);
    archive.number(rho);
  }
};

/// A method of the frame path. `problem` is the struct of the method's own that is derived from FrameProblem.
template <class T>
struct Solver {
  /// Bytes of workspace that solve() uses, exactly.
  std::size_t (*bytes)(const FrameProblem<T>& problem) noexcept;
  /// One frame: `y` and `weights` have problem.channels entries (weights null: all one), `workspace` has bytes() and is
  /// aligned to Workspace::alignment, x has problem.pixels(). Exactly problem.point.iterations iterations, unless the
  /// method says otherwise; the x handed out satisfies the constraint exactly.
  FrameInfo (*solve)(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                     float* x) noexcept;
  /// Makes the next frame in this workspace start cold; null where every frame does.
  void (*forget)(std::byte* workspace) noexcept;
};

}  // namespace compueye::recon::core
