#pragma once

#include <cstddef>

namespace compueye::recon::core {

/// Orthonormal DCT-II of one length, any length, as tables that somebody else owns (made by recon/dct_tables.hpp).
///
/// While the length is even it is split: sums of mirrored samples give the even coefficients by a DCT of half the
/// length, their differences give the odd ones by a dense half x half matrix (Chen, Smith & Fralick 1977, eq. 6-9).
/// What remains odd is one dense matrix. 160 = 2^5 * 5 costs 8,550 multiplications instead of 25,600.
/// `values` holds, one after the other, the odd-coefficient matrices from the outermost level inward and last the dense
/// remainder, row-major by coefficient, with every orthonormal factor already in.
template <class T>
struct DctTable {
  std::size_t length = 0;
  const T* values = nullptr;

  [[nodiscard]] static constexpr std::size_t size(std::size_t length) noexcept {
    std::size_t total = 0;
    while (length % 2 == 0) {
      length /= 2;
      total += length * length;
    }
    return total + length * length;
  }
};

/// The 2-D transform Psi of a rows x cols picture, row-major; the basis of every `dct` objective.
template <class T>
struct Dct2d {
  DctTable<T> rows;  ///< table of length = number of rows, applied down the columns
  DctTable<T> cols;
};

/// Elements of T that the transforms want as scratch for pictures up to rows x cols.
[[nodiscard]] constexpr std::size_t dct_scratch_size(std::size_t rows, std::size_t cols) noexcept {
  const std::size_t longest = rows > cols ? rows : cols;
  return 3 * longest * 16;
}

/// out = Psi in; in and out may be the same picture.
void dct_forward(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept;
void dct_forward(const Dct2d<double>& psi, const double* in, double* out, double* scratch) noexcept;

/// out = Psi' in, the inverse.
void dct_inverse(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept;
void dct_inverse(const Dct2d<double>& psi, const double* in, double* out, double* scratch) noexcept;

}  // namespace compueye::recon::core
