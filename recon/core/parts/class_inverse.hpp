#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/crew.hpp"
#include "recon/core/parts/packed_symmetric.hpp"

namespace compueye::recon::core {

/// (A K0^-1 A' + rho I)^-1 by parity classes (recon/setup/parity_classes.hpp): four matrices of a quarter the order
/// where A is mirror symmetric, a quarter of the bytes of the whole one; or the whole one.
template <class T>
struct ClassInverse {
  struct Part {
    PackedSymmetric<T> matrix;
    const std::int32_t* index = nullptr;  ///< order of them: a row's place in the matrix, -1 for none; null: its own
    const T* share = nullptr;             ///< order of them: entry of the class's unit vector at a row
  };

  std::size_t order = 0;  ///< rows of A
  std::size_t classes = 0;
  Part parts[4];
  Crew crew = {};  ///< shares classes

  /// Elements of T that multiply() and expand_row() want as scratch.
  [[nodiscard]] std::size_t scratch_size() const noexcept { return classes > 1 ? 2 * order : 0; }
};

/// y = H x; reads every stored value once. Classes are added in ascending order.
void multiply(const ClassInverse<float>& h, const float* x, float* y, float* scratch) noexcept;
void multiply(const ClassInverse<double>& h, const double* x, double* y, double* scratch) noexcept;

/// Row i of the whole matrix, order values.
void expand_row(const ClassInverse<float>& h, std::size_t i, float* row, float* scratch) noexcept;
void expand_row(const ClassInverse<double>& h, std::size_t i, double* row, double* scratch) noexcept;

}  // namespace compueye::recon::core
