#pragma once

#include <cstddef>

#include "recon/core/parts/crew.hpp"
#include "recon/core/parts/proximal.hpp"

namespace compueye::recon::core {

/// Orthonormal DCT-II of one length, any length, as tables that somebody else owns (made by
/// recon/setup/basis_tables.hpp).
///
/// While the length is even it is split: sums of mirrored samples give the even coefficients by a DCT-II of half the
/// length, their differences give the odd ones by a DCT-IV of half the length (Chen, Smith & Fralick 1977, eq. 6-9).
/// A DCT-IV of even length from `rotated_from` on is split once more, by rotations of mirrored samples, into two
/// DCT-II of half its length (Plonka & Tasche 2005, "Fast and numerically stable algorithms for discrete cosine
/// transforms", lemma 2.3); shorter ones are dense, and so is what remains odd of the DCT-II. 160 = 2^5 * 5 costs 2,100
/// multiplications instead of 25,600.
///
/// `values` holds cosines and sines of the rotated levels, from the outermost inward, and then the dense matrices,
/// row-major by coefficient, of every level that is not rotated or that a rotated one's DCT-II go through, and last the
/// dense remainder. Every orthonormal factor is already in.
template <class T>
struct DctTable {
  std::size_t length = 0;
  const T* values = nullptr;

  static constexpr std::size_t rotated_from = 12;
  /// Whether the level that splits 2 * half is rotated; dense matrices of half the length are quicker below.
  [[nodiscard]] static constexpr bool rotated(std::size_t half) noexcept {
    return half >= rotated_from && half % 2 == 0;
  }
  /// Whether the table has the dense matrix of that level.
  [[nodiscard]] static constexpr bool dense(std::size_t half, std::size_t length) noexcept {
    return !rotated(half) || 8 * half <= length;
  }
  /// Values that a DCT-II of n by halving alone takes.
  [[nodiscard]] static constexpr std::size_t halving_size(std::size_t n) noexcept {
    std::size_t total = 0;
    while (n % 2 == 0) {
      n /= 2;
      total += n * n;
    }
    return total + n * n;
  }
  [[nodiscard]] static constexpr std::size_t size(std::size_t length) noexcept {
    std::size_t total = 0, n = length;
    while (n % 2 == 0) {
      n /= 2;
      total += (rotated(n) ? n : 0) + (dense(n, length) ? n * n : 0);
    }
    return total + n * n;
  }
  /// The matrices of the DCT-II of n, a level's length, by halving alone.
  [[nodiscard]] const T* halving(std::size_t n) const noexcept { return values + (size(length) - halving_size(n)); }
};

/// The 2-D transform Psi of a rows x cols picture, row-major; the basis of every `dct` objective.
template <class T>
struct Dct2d {
  DctTable<T> rows;  ///< table of length = number of rows, applied down the columns
  DctTable<T> cols;
  Crew crew = {};  ///< shares strips of 16 columns, then of 16 rows
};

/// Elements of T that the transforms want as scratch for pictures up to rows x cols, times the workers that share them.
[[nodiscard]] constexpr std::size_t dct_scratch_size(std::size_t rows, std::size_t cols) noexcept {
  const std::size_t longest = rows > cols ? rows : cols;
  return 4 * longest * 16;
}

/// out = Psi in; in and out may be the same picture.
void dct_forward(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept;
void dct_forward(const Dct2d<double>& psi, const double* in, double* out, double* scratch) noexcept;

/// out = Psi' in, the inverse.
void dct_inverse(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept;
void dct_inverse(const Dct2d<double>& psi, const double* in, double* out, double* scratch) noexcept;

/// A picture of coefficients as the transform along rows leaves it: strips of 16 rows, each column by column, lanes
/// beyond the picture zero. Elements of T that it takes, and where the coefficient of row r and column c is.
[[nodiscard]] constexpr std::size_t dct_strips_size(std::size_t rows, std::size_t cols) noexcept {
  return (rows + 15) / 16 * 16 * cols;
}
[[nodiscard]] constexpr std::size_t dct_strip_element(std::size_t r, std::size_t c, std::size_t cols) noexcept {
  return (r / 16 * cols + c) * 16 + r % 16;
}

/// Moves a dual of ||Psi x||_1 that is kept in strips by Psi in, and out = Psi' dual: what dct_forward(), ascend() and
/// dct_inverse() do, with one pass over the rows instead of three. in and out may be the same picture.
void dct_ascend(const Dct2d<float>& psi, const Ascent<float>& ascent, const float* in, float* dual, float* out,
                float* scratch) noexcept;
void dct_ascend(const Dct2d<double>& psi, const Ascent<double>& ascent, const double* in, double* dual, double* out,
                double* scratch) noexcept;

}  // namespace compueye::recon::core
