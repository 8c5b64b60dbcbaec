#pragma once

#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// FISTA (Beck & Teboulle 2009, "A fast iterative shrinkage-thresholding algorithm", section 4) with adaptive restart
/// by the gradient scheme (O'Donoghue & Candes 2015, section 3.2). One proximal map must do for the l1 term and the
/// constraint together, so it takes pixels with any constraint, or an orthonormal basis with none.
///
/// Steps of 1 / problem.lipschitz; exactly problem.point.iterations iterations. Health by the duality gap.
template <class T>
struct FistaProblem : FrameProblem<T> {
  static constexpr std::string_view method = "fista";
  static const Solver<T> solver;

  T lipschitz = T(1);  ///< at least ||A||_2^2

  template <class Archive>
  void fields(Archive& archive) {
    archive.number(lipschitz);
  }
};

extern template struct FistaProblem<float>;
extern template struct FistaProblem<double>;

}  // namespace compueye::recon::core
