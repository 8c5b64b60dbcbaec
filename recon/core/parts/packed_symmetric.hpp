#pragma once

#include <cstddef>

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

}  // namespace compueye::recon::core
