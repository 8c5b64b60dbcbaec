#pragma once

#include <cstddef>

#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

// A strip is a number of rows of 16 signals side by side: each signal is transformed on its own lane, so that vector
// width cannot change the order of any sum.

/// Strips that `count` columns or rows make.
[[nodiscard]] constexpr std::size_t strips_of(std::size_t count) noexcept {
  return (count + lanes - 1) / lanes;
}

/// A strip of the picture columns from `in` on: `rows` rows, `pitch` apart, and `width` columns of them; lanes beyond
/// are zero. And back.
void columns_to_strip(const float* in, std::size_t rows, std::size_t pitch, std::size_t width, float* strip) noexcept;
void columns_to_strip(const double* in, std::size_t rows, std::size_t pitch, std::size_t width, double* strip) noexcept;
void strip_to_columns(const float* strip, std::size_t rows, std::size_t pitch, std::size_t width, float* out) noexcept;
void strip_to_columns(const double* strip, std::size_t rows, std::size_t pitch, std::size_t width,
                      double* out) noexcept;

/// The same of `height` picture rows of `cols` columns, each row on a lane of its own.
void rows_to_strip(const float* in, std::size_t height, std::size_t pitch, std::size_t cols, float* strip) noexcept;
void rows_to_strip(const double* in, std::size_t height, std::size_t pitch, std::size_t cols, double* strip) noexcept;
void strip_to_rows(const float* strip, std::size_t height, std::size_t pitch, std::size_t cols, float* out) noexcept;
void strip_to_rows(const double* strip, std::size_t height, std::size_t pitch, std::size_t cols, double* out) noexcept;

/// Columns or rows of strip s of `count`.
[[nodiscard]] constexpr std::size_t strip_width(std::size_t s, std::size_t count) noexcept {
  return count - s * lanes < lanes ? count - s * lanes : lanes;
}

/// Runs `transform(strip, result, work)` down every column of the upper left rows x cols part of a picture whose rows
/// are `pitch` apart. `scratch` holds three strips of `rows` rows.
template <class T, class Transform>
void along_columns(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out, T* scratch,
                   Transform transform) {
  T *strip = scratch, *result = scratch + rows * lanes, *work = scratch + 2 * rows * lanes;
  for (std::size_t s = 0; s < strips_of(cols); ++s) {
    columns_to_strip(in + s * lanes, rows, pitch, strip_width(s, cols), strip);
    transform(strip, result, work);
    strip_to_columns(result, rows, pitch, strip_width(s, cols), out + s * lanes);
  }
}

/// The same along every row.
template <class T, class Transform>
void along_rows(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out, T* scratch,
                Transform transform) {
  T *strip = scratch, *result = scratch + cols * lanes, *work = scratch + 2 * cols * lanes;
  for (std::size_t s = 0; s < strips_of(rows); ++s) {
    rows_to_strip(in + s * lanes * pitch, strip_width(s, rows), pitch, cols, strip);
    transform(strip, result, work);
    strip_to_rows(result, strip_width(s, rows), pitch, cols, out + s * lanes * pitch);
  }
}

// Functions of their own, not inlined like the rest of a transform: a dozen places call them, and a copy for each
// place, processor level and precision took the compiler longer than all other of recon/core.

/// Strip row k * out_stride of `out` = sum_r c[k * n + r] (strip row r of `in`), for k < n; the strips do not overlap.
void strip_product(const float* c, std::size_t n, const float* in, float* out, std::size_t out_stride) noexcept;
void strip_product(const double* c, std::size_t n, const double* in, double* out, std::size_t out_stride) noexcept;

/// The same by c', row by row: strip row k of `out` = sum_r c[r * n + k] (strip row r of `in`).
void strip_product_transposed(const float* c, std::size_t n, const float* in, float* out) noexcept;
void strip_product_transposed(const double* c, std::size_t n, const double* in, double* out) noexcept;

}  // namespace compueye::recon::core
