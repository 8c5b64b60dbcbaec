#include "recon/core/dct.hpp"

#include "recon/core/multiversion.hpp"
#include "recon/core/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

// A strip is `length` rows of 16 signals side by side: every signal is transformed on its own lane, so that vector
// width cannot change the order of any sum.

/// out[k * out_stride] = sum_r c[k * row_step + r * sample_step] in[r], for `n` outputs of `n` inputs, all rows of a
/// strip.
template <class T>
COMPUEYE_INLINE void strip_product(const T* c, std::size_t row_step, std::size_t sample_step, const T* __restrict in,
                                   T* __restrict out, std::size_t out_stride, std::size_t n) {
  std::size_t k = 0;
  for (; k + 2 <= n; k += 2) {
    T first[lanes] = {}, second[lanes] = {};
    for (std::size_t r = 0; r < n; ++r) {
      const T c0 = c[k * row_step + r * sample_step];
      const T c1 = c[(k + 1) * row_step + r * sample_step];
      for (std::size_t l = 0; l < lanes; ++l) {
        first[l] += c0 * in[r * lanes + l];
        second[l] += c1 * in[r * lanes + l];
      }
    }
    for (std::size_t l = 0; l < lanes; ++l) {
      out[k * out_stride * lanes + l] = first[l];
      out[(k + 1) * out_stride * lanes + l] = second[l];
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

/// strip (length rows) -> out (length rows); `work` takes length rows.
template <class T>
COMPUEYE_INLINE void strip_forward(const DctTable<T>& table, T* __restrict strip, T* __restrict out, T* work) {
  const T* c = table.values;
  std::size_t n = table.length;
  std::size_t stride = 1;
  while (n % 2 == 0) {
    const std::size_t half = n / 2;
    T* difference = work;
    for (std::size_t r = 0; r < half; ++r) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const T a = strip[r * lanes + l], b = strip[(n - 1 - r) * lanes + l];
        strip[r * lanes + l] = a + b;
        difference[r * lanes + l] = a - b;
      }
    }
    strip_product(c, half, std::size_t{1}, difference, out + stride * lanes, 2 * stride, half);
    c += half * half;
    n = half;
    stride *= 2;
  }
  strip_product(c, n, std::size_t{1}, strip, out, stride, n);
}

/// The transpose of strip_forward: levels undone from the innermost outward.
template <class T>
COMPUEYE_INLINE void strip_inverse(const DctTable<T>& table, const T* __restrict strip, T* __restrict out, T* work) {
  const std::size_t total = DctTable<T>::size(table.length);
  std::size_t n = table.length;
  std::size_t stride = 1;
  while (n % 2 == 0) {
    n /= 2;
    stride *= 2;
  }
  const T* c = table.values + (total - n * n);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < lanes; ++l) work[k * lanes + l] = strip[k * stride * lanes + l];
  }
  strip_product(c, std::size_t{1}, n, work, out, std::size_t{1}, n);
  while (n < table.length) {
    const std::size_t odd_stride = stride;
    stride /= 2;
    c -= n * n;
    T* odd = work + n * lanes;
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t l = 0; l < lanes; ++l) work[k * lanes + l] = strip[(k * odd_stride + stride) * lanes + l];
    }
    strip_product(c, std::size_t{1}, n, work, odd, std::size_t{1}, n);
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const T even = out[r * lanes + l], difference = odd[r * lanes + l];
        out[r * lanes + l] = even + difference;
        out[(2 * n - 1 - r) * lanes + l] = even - difference;
      }
    }
    n *= 2;
  }
}

template <class T>
COMPUEYE_INLINE void strip_transform(bool inverse, const DctTable<T>& table, T* strip, T* out, T* work) {
  if (inverse) {
    strip_inverse(table, strip, out, work);
  } else {
    strip_forward(table, strip, out, work);
  }
}

template <class T>
COMPUEYE_INLINE void transform_columns(bool inverse, const DctTable<T>& table, std::size_t cols, const T* in, T* out,
                                       T* scratch) {
  const std::size_t n = table.length;
  T *strip = scratch, *result = scratch + n * lanes, *work = scratch + 2 * n * lanes;
  for (std::size_t first = 0; first < cols; first += lanes) {
    const std::size_t width = cols - first < lanes ? cols - first : lanes;
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t l = 0; l < width; ++l) strip[r * lanes + l] = in[r * cols + first + l];
      for (std::size_t l = width; l < lanes; ++l) strip[r * lanes + l] = T(0);
    }
    strip_transform(inverse, table, strip, result, work);
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t l = 0; l < width; ++l) out[r * cols + first + l] = result[r * lanes + l];
    }
  }
}

template <class T>
COMPUEYE_INLINE void transform_rows(bool inverse, const DctTable<T>& table, std::size_t rows, const T* in, T* out,
                                    T* scratch) {
  const std::size_t n = table.length;
  T *strip = scratch, *result = scratch + n * lanes, *work = scratch + 2 * n * lanes;
  for (std::size_t first = 0; first < rows; first += lanes) {
    const std::size_t height = rows - first < lanes ? rows - first : lanes;
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t l = 0; l < height; ++l) strip[c * lanes + l] = in[(first + l) * n + c];
      for (std::size_t l = height; l < lanes; ++l) strip[c * lanes + l] = T(0);
    }
    strip_transform(inverse, table, strip, result, work);
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t l = 0; l < height; ++l) out[(first + l) * n + c] = result[c * lanes + l];
    }
  }
}

template <class T>
COMPUEYE_INLINE void transform_2d(bool inverse, const Dct2d<T>& psi, const T* in, T* out, T* scratch) {
  transform_columns(inverse, psi.rows, psi.cols.length, in, out, scratch);
  transform_rows(inverse, psi.cols, psi.rows.length, out, out, scratch);
}

}  // namespace

COMPUEYE_MULTIVERSION void dct_forward(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept {
  transform_2d(false, psi, in, out, scratch);
}
COMPUEYE_MULTIVERSION void dct_forward(const Dct2d<double>& psi, const double* in, double* out,
                                       double* scratch) noexcept {
  transform_2d(false, psi, in, out, scratch);
}
COMPUEYE_MULTIVERSION void dct_inverse(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept {
  transform_2d(true, psi, in, out, scratch);
}
COMPUEYE_MULTIVERSION void dct_inverse(const Dct2d<double>& psi, const double* in, double* out,
                                       double* scratch) noexcept {
  transform_2d(true, psi, in, out, scratch);
}

}  // namespace compueye::recon::core
