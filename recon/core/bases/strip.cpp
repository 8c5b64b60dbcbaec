#include "recon/core/bases/strip.hpp"

#include "recon/core/parts/lane_vectors.hpp"
#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

/// The 16 picture rows from `rows` on as columns of a strip, or back; four by four, so that both sides are whole
/// vectors.
template <class T>
COMPUEYE_INLINE void whole_rows_in(const T* __restrict rows, std::size_t pitch, std::size_t cols, T* __restrict strip) {
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
COMPUEYE_INLINE void whole_rows_out(const T* __restrict strip, std::size_t pitch, std::size_t cols,
                                    T* __restrict rows) {
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
COMPUEYE_INLINE void columns_in(const T* in, std::size_t rows, std::size_t pitch, std::size_t width, T* strip) {
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
COMPUEYE_INLINE void columns_out(const T* strip, std::size_t rows, std::size_t pitch, std::size_t width, T* out) {
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
constexpr bool turns_vectors = false;
#else
constexpr bool turns_vectors = true;
#endif

/// The same of `height` rows; a whole strip's are turned as vectors.
template <class T>
COMPUEYE_INLINE void rows_in(const T* in, std::size_t height, std::size_t pitch, std::size_t cols, T* strip) {
  if (turns_vectors && height == lanes) return whole_rows_in(in, pitch, cols, strip);
  for (std::size_t c = 0; c < cols; ++c) {
    for (std::size_t l = 0; l < height; ++l) strip[c * lanes + l] = in[l * pitch + c];
    for (std::size_t l = height; l < lanes; ++l) strip[c * lanes + l] = T(0);
  }
}

template <class T>
COMPUEYE_INLINE void rows_out(const T* strip, std::size_t height, std::size_t pitch, std::size_t cols, T* out) {
  if (turns_vectors && height == lanes) return whole_rows_out(strip, pitch, cols, out);
  for (std::size_t c = 0; c < cols; ++c) {
    for (std::size_t l = 0; l < height; ++l) out[l * pitch + c] = strip[c * lanes + l];
  }
}

}  // namespace

COMPUEYE_MULTIVERSION void columns_to_strip(const float* in, std::size_t rows, std::size_t pitch, std::size_t width,
                                            float* strip) noexcept {
  columns_in(in, rows, pitch, width, strip);
}
COMPUEYE_MULTIVERSION void columns_to_strip(const double* in, std::size_t rows, std::size_t pitch, std::size_t width,
                                            double* strip) noexcept {
  columns_in(in, rows, pitch, width, strip);
}
COMPUEYE_MULTIVERSION void strip_to_columns(const float* strip, std::size_t rows, std::size_t pitch, std::size_t width,
                                            float* out) noexcept {
  columns_out(strip, rows, pitch, width, out);
}
COMPUEYE_MULTIVERSION void strip_to_columns(const double* strip, std::size_t rows, std::size_t pitch, std::size_t width,
                                            double* out) noexcept {
  columns_out(strip, rows, pitch, width, out);
}
COMPUEYE_MULTIVERSION void rows_to_strip(const float* in, std::size_t height, std::size_t pitch, std::size_t cols,
                                         float* strip) noexcept {
  rows_in(in, height, pitch, cols, strip);
}
COMPUEYE_MULTIVERSION void rows_to_strip(const double* in, std::size_t height, std::size_t pitch, std::size_t cols,
                                         double* strip) noexcept {
  rows_in(in, height, pitch, cols, strip);
}
COMPUEYE_MULTIVERSION void strip_to_rows(const float* strip, std::size_t height, std::size_t pitch, std::size_t cols,
                                         float* out) noexcept {
  rows_out(strip, height, pitch, cols, out);
}
COMPUEYE_MULTIVERSION void strip_to_rows(const double* strip, std::size_t height, std::size_t pitch, std::size_t cols,
                                         double* out) noexcept {
  rows_out(strip, height, pitch, cols, out);
}

namespace {

/// How many lanes of two outputs fit into a processor's registers: a Cortex-M has room for 32 single numbers.
#if defined(COMPUEYE_CORTEX_M)
constexpr std::size_t lanes_at_once = lanes / 2;
#else
constexpr std::size_t lanes_at_once = lanes;
#endif

/// out[k * out_stride] = sum_r c[k * row_step + r * sample_step] in[r], for `n` outputs of `n` inputs, each a strip
/// row.
template <class T>
COMPUEYE_INLINE void product(const T* c, std::size_t row_step, std::size_t sample_step, const T* __restrict in,
                             T* __restrict out, std::size_t out_stride, std::size_t n) {
  std::size_t k = 0;
  for (; lanes_at_once == lanes && k + 4 <= n; k += 4) {
    T sum[4][lanes] = {};
    const T* row = c + k * row_step;
    for (std::size_t r = 0; r < n; ++r, row += sample_step) {
      const T c0 = row[0], c1 = row[row_step], c2 = row[2 * row_step], c3 = row[3 * row_step];
      for (std::size_t l = 0; l < lanes; ++l) {
        const T x = in[r * lanes + l];
        sum[0][l] += c0 * x;
        sum[1][l] += c1 * x;
        sum[2][l] += c2 * x;
        sum[3][l] += c3 * x;
      }
    }
    for (std::size_t o = 0; o < 4; ++o) {
      for (std::size_t l = 0; l < lanes; ++l) out[(k + o) * out_stride * lanes + l] = sum[o][l];
    }
  }
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

}  // namespace

COMPUEYE_MULTIVERSION void strip_product(const float* c, std::size_t n, const float* in, float* out,
                                         std::size_t out_stride) noexcept {
  product(c, n, std::size_t{1}, in, out, out_stride, n);
}
COMPUEYE_MULTIVERSION void strip_product(const double* c, std::size_t n, const double* in, double* out,
                                         std::size_t out_stride) noexcept {
  product(c, n, std::size_t{1}, in, out, out_stride, n);
}
COMPUEYE_MULTIVERSION void strip_product_transposed(const float* c, std::size_t n, const float* in,
                                                    float* out) noexcept {
  product(c, std::size_t{1}, n, in, out, std::size_t{1}, n);
}
COMPUEYE_MULTIVERSION void strip_product_transposed(const double* c, std::size_t n, const double* in,
                                                    double* out) noexcept {
  product(c, std::size_t{1}, n, in, out, std::size_t{1}, n);
}

}  // namespace compueye::recon::core
