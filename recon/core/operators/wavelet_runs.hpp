#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/operators/wavelet_picture.hpp"
#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// A = C S' for rows that are smooth pictures, as a soft-edged receptive field times a slowly changing sensitivity is:
/// S' measures the picture's coefficients in a wavelet basis once for all rows, C holds those tiles of each row's
/// coefficients that are not negligible (Beylkin, Coifman & Rokhlin 1991, "Fast wavelet transforms and numerical
/// algorithms I"). Four rows, any that have many of them in common, make a block and share their tiles; what one of
/// them does not have is nought there.
///
/// Averages carry nearly all of a row and are held as bfloat16: words[32 t + 16 h + k] is row 2h in its lower half and
/// row 2h+1 in its upper, at coefficient k of the t-th tile of the list. Details are whole numbers times a scale of
/// their row: byte l of words[16 t + k], counted from the lowest, is row l.
template <class T>
struct WaveletRuns {
  static constexpr std::size_t rows_at_once = 4;
  static constexpr std::size_t average_words = 32, detail_words = 16;  ///< a tile

  struct Tiles {
    const std::uint32_t* first = nullptr;  ///< blocks * bands + 1: block b's in band k are first[b*bands+k] ..
    const std::uint16_t* place = nullptr;  ///< of each: its number among the picture's, ascending in a block
    const std::uint32_t* words = nullptr;
  };

  WaveletPicture picture;
  std::size_t blocks = 0;
  std::size_t bands = 1;  ///< ranges of tiles of the picture, so that each of A' y can be computed by itself
  Tiles averages, details;
  const T* scale = nullptr;             ///< of details: 4 blocks
  const std::int32_t* row = nullptr;    ///< 4 blocks: the row of A, -1 where the last block has none
  const std::uint32_t* band = nullptr;  ///< bands + 1: the first tile of each, then all tiles

  /// Elements of T that forward() and adjoint_accumulate() want as scratch, aligned to 64 bytes.
  [[nodiscard]] std::size_t scratch_size(std::size_t workers) const noexcept {
    return picture.coefficients() + (picture.rows * picture.cols + 15) / 16 * 16 + picture.scratch_size(workers);
  }
};

/// Bytes of tables that one application reads, and its multiply-adds, those of lifting among them.
std::size_t bytes(const WaveletRuns<float>& a) noexcept;
std::size_t bytes(const WaveletRuns<double>& a) noexcept;
std::size_t flops(const WaveletRuns<float>& a) noexcept;
std::size_t flops(const WaveletRuns<double>& a) noexcept;

/// y = A x. Coefficient k of a tile goes to lane k of 16, tiles ascending; the lanes of details times their scale are
/// added to those of averages, then lanes as in core/vector_sums.hpp.
void forward(const WaveletRuns<float>& a, const float* x, float* y, float* scratch, const Crew& crew = {}) noexcept;
void forward(const WaveletRuns<double>& a, const double* x, double* y, double* scratch, const Crew& crew = {}) noexcept;

/// x += A' y: to each coefficient rows in the order of their blocks. Workers share blocks in the one and bands in the
/// other.
void adjoint_accumulate(const WaveletRuns<float>& a, const float* y, float* x, float* scratch,
                        const Crew& crew = {}) noexcept;
void adjoint_accumulate(const WaveletRuns<double>& a, const double* y, double* x, double* scratch,
                        const Crew& crew = {}) noexcept;

}  // namespace compueye::recon::core
