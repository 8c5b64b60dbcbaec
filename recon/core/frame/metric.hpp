#pragma once

#include <cstddef>

#include "recon/core/bases/dct.hpp"

namespace compueye::recon::core {

/// K0 of the quadratic step rho/2 (x - v)' K0 (x - v). The identity for an orthonormal basis; D'D + I for total
/// variation, whose inverse is diagonal in the 2-D DCT.
template <class T>
struct Metric {
  const T* inverse_eigenvalues = nullptr;  ///< one a DCT coefficient; null: K0 = I
  Dct2d<T> dct;

  [[nodiscard]] bool is_identity() const noexcept { return inverse_eigenvalues == nullptr; }
};

/// x becomes K0^-1 x; `coefficients` takes a picture, `scratch` what the DCT wants.
template <class T>
void apply_inverse(const Metric<T>& metric, T* x, T* coefficients, T* scratch) noexcept;

}  // namespace compueye::recon::core
