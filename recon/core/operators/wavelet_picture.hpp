#pragma once

#include <cstddef>

#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// A picture as averages of four by four pixels and as details of one and of two: two levels of the 9/7 wavelet
/// (core/operators/lifting.hpp), averages first, then the details of the coarser level, then of the finer one; of each
/// level those across, those down, those of both. Every such part is cut into tiles of 4 x 4 coefficients, row-major
/// one after the other, each tile row-major too: a smooth row of A needs few tiles, and a tile is one group of
/// core/operators/dense_runs.hpp. Where a side is no multiple of four the last tiles are filled up with noughts.
///
/// Any numbers of rows and columns from 2 on. A row a of A, as a picture, is S c with S the synthesis and c its
/// coefficients: a'x = c'(S'x).
struct WaveletPicture {
  std::size_t rows = 0;
  std::size_t cols = 0;

  static constexpr std::size_t levels = 2;
  static constexpr std::size_t tile_side = 4;
  static constexpr std::size_t tile = tile_side * tile_side;

  /// Sides of the picture that level 0 (the finer one) or 1 takes apart; of levels: of what is left.
  [[nodiscard]] constexpr std::size_t rows_at(std::size_t level) const noexcept { return halved(rows, level); }
  [[nodiscard]] constexpr std::size_t cols_at(std::size_t level) const noexcept { return halved(cols, level); }

  /// With noughts that fill up tiles.
  [[nodiscard]] constexpr std::size_t averages() const noexcept { return tiled(rows_at(levels), cols_at(levels)); }
  [[nodiscard]] constexpr std::size_t details_at(std::size_t level) const noexcept {
    const std::size_t low_rows = rows_at(level + 1), low_cols = cols_at(level + 1);
    const std::size_t high_rows = rows_at(level) - low_rows, high_cols = cols_at(level) - low_cols;
    return tiled(low_rows, high_cols) + tiled(high_rows, low_cols) + tiled(high_rows, high_cols);
  }
  [[nodiscard]] constexpr std::size_t coefficients() const noexcept {
    return averages() + details_at(1) + details_at(0);
  }

  /// Elements of T that the functions below want as scratch, aligned to 64 bytes.
  [[nodiscard]] std::size_t scratch_size(std::size_t workers) const noexcept;

  [[nodiscard]] static constexpr std::size_t tiles(std::size_t side) noexcept {
    return (side + tile_side - 1) / tile_side;
  }
  [[nodiscard]] static constexpr std::size_t tiled(std::size_t height, std::size_t width) noexcept {
    return tiles(height) * tiles(width) * tile;
  }

 private:
  [[nodiscard]] static constexpr std::size_t halved(std::size_t side, std::size_t times) noexcept {
    for (; times > 0; --times) side = (side + 1) / 2;
    return side;
  }
};

/// coefficients = S' x: what the rows' coefficients are multiplied by.
void wavelet_measure(const WaveletPicture& shape, const float* x, float* coefficients, float* scratch,
                     const Crew& crew = {}) noexcept;
void wavelet_measure(const WaveletPicture& shape, const double* x, double* coefficients, double* scratch,
                     const Crew& crew = {}) noexcept;

/// x = S coefficients
void wavelet_synthesise(const WaveletPicture& shape, const float* coefficients, float* x, float* scratch,
                        const Crew& crew = {}) noexcept;
void wavelet_synthesise(const WaveletPicture& shape, const double* coefficients, double* x, double* scratch,
                        const Crew& crew = {}) noexcept;

/// coefficients = S^(-1) x: of a row of A.
void wavelet_analyse(const WaveletPicture& shape, const double* x, double* coefficients, double* scratch) noexcept;

}  // namespace compueye::recon::core
