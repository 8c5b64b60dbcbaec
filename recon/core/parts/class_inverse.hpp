#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// A symmetric matrix by its upper triangle: row i holds columns i .. order-1, rows one after the other.
template <class T>
struct PackedSymmetric {
  std::size_t order = 0;
  const T* values = nullptr;

  [[nodiscard]] static constexpr std::size_t size(std::size_t order) noexcept { return order * (order + 1) / 2; }
  [[nodiscard]] std::size_t row(std::size_t i) const noexcept { return i * order - i * (i - 1) / 2; }
  [[nodiscard]] T at(std::size_t i, std::size_t j) const noexcept {
    return i <= j ? values[row(i) + (j - i)] : values[row(j) + (i - j)];
  }
};

/// y = H x; reads every stored value once: bound by memory at 2 order^2 bytes (float32) a product.
void multiply(const PackedSymmetric<float>& h, const float* x, float* y) noexcept;
void multiply(const PackedSymmetric<double>& h, const double* x, double* y) noexcept;

/// Row i of the whole symmetric matrix, order values.
void expand_row(const PackedSymmetric<float>& h, std::size_t i, float* row) noexcept;
void expand_row(const PackedSymmetric<double>& h, std::size_t i, double* row) noexcept;

/// (A K0^-1 A' + rho I)^-1 by parity classes (recon/setup/mirror_symmetry.hpp): four matrices of a quarter the order
/// where A is mirror symmetric, a quarter of the bytes of the whole one; or the whole one.
template <class T>
struct ClassInverse {
  struct Part {
    PackedSymmetric<T> matrix;
    const std::int32_t* index = nullptr;  ///< order of them: a row's place in the matrix, -1 for none; null: its own
    const T* share = nullptr;             ///< order of them: entry of the class's unit vector at a row, times what the
                                          ///< matrix was scaled by there (recon/setup/row_norms.hpp)
  };

  std::size_t order = 0;  ///< rows of A
  std::size_t classes = 0;
  Part parts[4];
  Crew crew = {};  ///< shares classes

  /// Elements of T that multiply() and expand_row() want as scratch.
  [[nodiscard]] std::size_t scratch_size() const noexcept { return is_whole() ? 0 : 2 * order; }
  /// One matrix with every row in its own place, as it is.
  [[nodiscard]] bool is_whole() const noexcept { return classes == 1 && parts[0].index == nullptr; }
};

/// y = H x; reads every stored value once. Classes are added in ascending order.
void multiply(const ClassInverse<float>& h, const float* x, float* y, float* scratch) noexcept;
void multiply(const ClassInverse<double>& h, const double* x, double* y, double* scratch) noexcept;

/// Row i of the whole matrix, order values.
void expand_row(const ClassInverse<float>& h, std::size_t i, float* row, float* scratch) noexcept;
void expand_row(const ClassInverse<double>& h, std::size_t i, double* row, double* scratch) noexcept;

}  // namespace compueye::recon::core
