#pragma once

#include <cstddef>

namespace compueye::recon::core {

/// The discrete Fourier transform in real form: the orthonormal basis 1, cos, sin, ..., (-1)^r of each length, one
/// after the other by frequency, as a tensor product over rows and columns. Tables (length x length, row-major by
/// coefficient) are made by recon/setup/basis_tables.hpp and owned by somebody else.
template <class T>
struct Fourier2d {
  std::size_t rows = 0;
  std::size_t cols = 0;
  const T* row_table = nullptr;  ///< rows x rows
  const T* col_table = nullptr;  ///< cols x cols
};

/// out = Psi in; in and out may be the same picture. `scratch` takes dct_scratch_size() elements, as every separable
/// transform does.
void fourier_forward(const Fourier2d<float>& psi, const float* in, float* out, float* scratch) noexcept;
void fourier_forward(const Fourier2d<double>& psi, const double* in, double* out, double* scratch) noexcept;

/// out = Psi' in, the inverse.
void fourier_inverse(const Fourier2d<float>& psi, const float* in, float* out, float* scratch) noexcept;
void fourier_inverse(const Fourier2d<double>& psi, const double* in, double* out, double* scratch) noexcept;

}  // namespace compueye::recon::core
