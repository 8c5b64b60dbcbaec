#pragma once

#include <cstddef>

#include "recon/core/multiversion.hpp"
#include "recon/core/vector_sums.hpp"

namespace compueye::recon::core {

// A strip is a number of rows of 16 signals side by side: each signal is transformed on its own lane, so that vector
// width cannot change the order of any sum.

/// How many lanes of two outputs fit into a processor's registers: a Cortex-M has room for 32 single numbers.
#if defined(COMPUEYE_CORTEX_M)
inline constexpr std::size_t lanes_at_once = lanes / 2;
#else
inline constexpr std::size_t lanes_at_once = lanes;
#endif

/// out[k * out_stride] = sum_r c[k * row_step + r * sample_step] in[r], for `n` outputs of `n` inputs, each a strip
/// row.
template <class T>
COMPUEYE_INLINE void strip_product(const T* c, std::size_t row_step, std::size_t sample_step, const T* __restrict in,
                                   T* __restrict out, std::size_t out_stride, std::size_t n) {
  std::size_t k = 0;
  for (; k + 2 <= n; k += 2) {
    for (std::size_t begin = 0; begin < lanes; begin += lanes_at_once) {
      T first[lanes_at_once] = {}, second[lanes_at_once] = {};
      for (std::size_t r = 0; r < n; ++r) {
        const T c0 = c[k * row_step + r * sample_step];
        const T c1 = c[(k + 1) * row_step + r * sample_step];
        for (std::size_t l = 0; l < lanes_at_once; ++l) {
          first[l] += c0 * in[r * lanes + begin + l];
          second[l] += c1 * in[r * lanes + begin + l];
        }
      }
      for (std::size_t l = 0; l < lanes_at_once; ++l) {
        out[k * out_stride * lanes + begin + l] = first[l];
        out[(k + 1) * out_stride * lanes + begin + l] = second[l];
      }
    }
  }
  if (k < n) {
    T sum[lanes] = {};
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t l = 0; l < lanes; ++l) sum[l] += c[k * row_step + r * sample_step] * in[r * lanes + l];
    }
    for (std::size_t l = 0; l < lanes; ++l) out[k * out_stride * lanes + l] = sum[l];
  }
}

/// Strips that `count` columns or rows make.
[[nodiscard]] constexpr std::size_t strips_of(std::size_t count) noexcept {
  return (count + lanes - 1) / lanes;
}

/// Runs `transform(strip, result, work)` down every column of the upper left rows x cols part of a picture whose rows
/// are `pitch` apart, in strips begin .. end-1 of strips_of(cols). `scratch` holds three strips of `rows` rows.
template <class T, class Transform>
COMPUEYE_INLINE void along_columns(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out,
                                   T* scratch, std::size_t begin, std::size_t end, Transform transform) {
  T *strip = scratch, *result = scratch + rows * lanes, *work = scratch + 2 * rows * lanes;
  for (std::size_t s = begin; s < end; ++s) {
    const std::size_t first = s * lanes;
    const std::size_t width = cols - first < lanes ? cols - first : lanes;
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t l = 0; l < width; ++l) strip[r * lanes + l] = in[r * pitch + first + l];
      for (std::size_t l = width; l < lanes; ++l) strip[r * lanes + l] = T(0);
    }
    transform(strip, result, work);
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t l = 0; l < width; ++l) out[r * pitch + first + l] = result[r * lanes + l];
    }
  }
}

/// The same along every row, in strips of strips_of(rows).
template <class T, class Transform>
COMPUEYE_INLINE void along_rows(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out, T* scratch,
                                std::size_t begin, std::size_t end, Transform transform) {
  T *strip = scratch, *result = scratch + cols * lanes, *work = scratch + 2 * cols * lanes;
  for (std::size_t s = begin; s < end; ++s) {
    const std::size_t first = s * lanes;
    const std::size_t height = rows - first < lanes ? rows - first : lanes;
    for (std::size_t c = 0; c < cols; ++c) {
      for (std::size_t l = 0; l < height; ++l) strip[c * lanes + l] = in[(first + l) * pitch + c];
      for (std::size_t l = height; l < lanes; ++l) strip[c * lanes + l] = T(0);
    }
    transform(strip, result, work);
    for (std::size_t c = 0; c < cols; ++c) {
      for (std::size_t l = 0; l < height; ++l) out[(first + l) * pitch + c] = result[c * lanes + l];
    }
  }
}

template <class T, class Transform>
COMPUEYE_INLINE void along_columns(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out,
                                   T* scratch, Transform transform) {
  along_columns(rows, cols, pitch, in, out, scratch, std::size_t{0}, strips_of(cols), transform);
}

template <class T, class Transform>
COMPUEYE_INLINE void along_rows(std::size_t rows, std::size_t cols, std::size_t pitch, const T* in, T* out, T* scratch,
                                Transform transform) {
  along_rows(rows, cols, pitch, in, out, scratch, std::size_t{0}, strips_of(rows), transform);
}

}  // namespace compueye::recon::core
