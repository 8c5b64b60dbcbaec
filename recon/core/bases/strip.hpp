#pragma once

#include <cstddef>

#include "recon/core/parts/lane_vectors.hpp"
#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

// A strip is a number of rows of 16 signals side by side: each signal is transformed on its own lane, so that vector
// width cannot change the order of any sum.

/// Strips that `count` columns or rows make.
[[nodiscard]] constexpr std::size_t strips_of(std::size_t count) noexcept {
  return (count + lanes - 1) / lanes;
}

/// The 16 picture rows from `rows` on as columns of a strip, or back; four by four, so that both sides are whole
/// vectors.
template <class T>
COMPUEYE_INLINE void rows_to_strip(const T* __restrict rows, std::size_t pitch, std::size_t cols, T* __restrict strip) {
  std::size_t c = 0;
  for (; c + 4 <= cols; c += 4) {
    for (std::size_t l = 0; l < lanes; l += 4) {
      Four<T> block[4];
      for (std::size_t k = 0; k < 4; ++k) block[k] = load_four(rows + (l + k) * pitch + c);
      transpose<T>(block);
      for (std::size_t k = 0; k < 4; ++k) store_four<T>(block[k], strip + (c + k) * lanes + l);
    }
  }
  for (; c < cols; ++c) {
    for (std::size_t l = 0; l < lanes; ++l) strip[c * lanes + l] = rows[l * pitch + c];
  }
}

template <class T>
COMPUEYE_INLINE void strip_to_rows(const T* __restrict strip, std::size_t pitch, std::size_t cols, T* __restrict rows) {
  std::size_t c = 0;
  for (; c + 4 <= cols; c += 4) {
    for (std::size_t l = 0; l < lanes; l += 4) {
      Four<T> block[4];
      for (std::size_t k = 0; k < 4; ++k) block[k] = load_four(strip + (c + k) * lanes + l);
      transpose<T>(block);
      for (std::size_t k = 0; k < 4; ++k) store_four<T>(block[k], rows + (l + k) * pitch + c);
    }
  }
  for (; c < cols; ++c) {
    for (std::size_t l = 0; l < lanes; ++l) rows[l * pitch + c] = strip[c * lanes + l];
  }
}

/// Columns first .. first+15 of `rows` rows, `width` of them there; lanes beyond are zero.
template <class T>
COMPUEYE_STAGE void columns_to_strip(const T* in, std::size_t rows, std::size_t pitch, std::size_t width, T* strip) {
  if (width == lanes) {
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t l = 0; l < lanes; ++l) strip[r * lanes + l] = in[r * pitch + l];
    }
    return;
  }
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t l = 0; l < width; ++l) strip[r * lanes + l] = in[r * pitch + l];
    for (std::size_t l = width; l < lanes; ++l) strip[r * lanes + l] = T(0);
  }
}

template <class T>
COMPUEYE_STAGE void strip_to_columns(const T* strip, std::size_t rows, std::size_t pitch, std::size_t width, T* out) {
  if (width == lanes) {
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t l = 0; l < lanes; ++l) out[r * pitch + l] = strip[r * lanes + l];
    }
    return;
  }
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t l = 0; l < width; ++l) out[r * pitch + l] = strip[r * lanes + l];
  }
}

/// Turning rows four by four is worth it where there are registers for it.
#if defined(COMPUEYE_CORTEX_M)
inline constexpr bool turns_vectors = false;
#else
inline constexpr bool turns_vectors = true;
#endif

/// The same of `height` rows; a whole strip's are turned as vectors.
template <class T>
COMPUEYE_STAGE void some_rows_to_strip(const T* in, std::size_t height, std::size_t pitch, std::size_t cols, T* strip) {
  if (turns_vectors && height == lanes) return rows_to_strip(in, pitch, cols, strip);
  for (std::size_t c = 0; c < cols; ++c) {
    for (std::size_t l = 0; l < height; ++l) strip[c * lanes + l] = in[l * pitch + c];
    for (std::size_t l = height; l < lanes; ++l) strip[c * lanes + l] = T(0);
  }
}

template <class T>
COMPUEYE_STAGE void strip_to_some_rows(const T* strip, std::size_t height, std::size_t pitch, std::size_t cols,
                                       T* out) {
  if (turns_vectors && height == lanes) return strip_to_rows(strip, pitch, cols, out);
  for (std::size_t c = 0; c < cols; ++c) {
    for (std::size_t l = 0; l < height; ++l) out[l * pitch + c] = strip[c * lanes + l];
  }
}

/// Columns or rows of strip s of `count`.
[[nodiscard]] constexpr std::size_t strip_width(std::size_t s, std::size_t count) noexcept {
  return count - s * lanes < lanes ? count - s * lanes : lanes;
}

/// Runs `transform(strip, result, work)` down every column of the upper left rows x cols part of a picture whose rows
/// are `pitch` apart. `scratch` holds three strips of `rows` rows.
template <class T, class Transform>
COMPUEYE_INLINE void along_columns(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out,
                                   T* scratch, Transform transform) {
  T *strip = scratch, *result = scratch + rows * lanes, *work = scratch + 2 * rows * lanes;
  for (std::size_t s = 0; s < strips_of(cols); ++s) {
    columns_to_strip(in + s * lanes, rows, pitch, strip_width(s, cols), strip);
    transform(strip, result, work);
    strip_to_columns(result, rows, pitch, strip_width(s, cols), out + s * lanes);
  }
}

/// The same along every row.
template <class T, class Transform>
COMPUEYE_INLINE void along_rows(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out, T* scratch,
                                Transform transform) {
  T *strip = scratch, *result = scratch + cols * lanes, *work = scratch + 2 * cols * lanes;
  for (std::size_t s = 0; s < strips_of(rows); ++s) {
    some_rows_to_strip(in + s * lanes * pitch, strip_width(s, rows), pitch, cols, strip);
    transform(strip, result, work);
    strip_to_some_rows(result, strip_width(s, rows), pitch, cols, out + s * lanes * pitch);
  }
}

}  // namespace compueye::recon::core
