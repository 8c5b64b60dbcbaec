#pragma once

#include <cstddef>
#include <string_view>

#include "recon/core/frame/frame_problem.hpp"

namespace compueye::recon::core {

/// Leading singular pairs of A: its left singular vectors and the inverse squares of its singular values.
template <class T>
struct SingularModes {
  std::size_t rank = 0;
  const T* left = nullptr;             ///< a.rows x rank, row-major
  const T* inverse_squares = nullptr;  ///< rank
};

/// Truncated singular value decomposition (Hansen 1998, "Rank-deficient and discrete ill-posed problems", section 3.2):
/// x = A' U S^-2 d over the `rank` leading singular pairs of A, with d = U'y; a linear answer, in pixels, without
/// iterations. With weights d minimises ||W^(1/2)(U d - y)||, which is what a fit within those pairs then means: with
/// D = I - W on the reweighted channels and P = U U', a channel's sample becomes w y + (1 - w) f, where f solves
/// (D^-1 - P) D f = P W y on those channels. Where they leave d open, the shortest d is meant.
///
/// The objective is 1/2 ||W^(1/2)(A x - y)||^2.
template <class T>
struct TsvdProblem : FrameProblem<T> {
  static constexpr std::string_view method = "tsvd";
  static const Solver<T> solver;

  SingularModes<T> modes;

  template <class Archive>
  void fields(Archive& archive) {
    archive.number(modes.rank);
    archive.table(modes.left, this->a.rows * modes.rank);
    archive.table(modes.inverse_squares, modes.rank);
  }
};

extern template struct TsvdProblem<float>;
extern template struct TsvdProblem<double>;

}  // namespace compueye::recon::core
