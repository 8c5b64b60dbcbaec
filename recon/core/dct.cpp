#include "recon/core/dct.hpp"

#include "recon/core/strip.hpp"

namespace compueye::recon::core {
namespace {

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
COMPUEYE_INLINE void transform_2d(bool inverse, const Dct2d<T>& psi, const T* in, T* out, T* scratch) {
  const std::size_t rows = psi.rows.length, cols = psi.cols.length;
  along_columns(
      rows, cols, cols, in, out, scratch, [&](T * strip, T * result, T * work) __attribute__((always_inline)) {
        strip_transform(inverse, psi.rows, strip, result, work);
      });
  along_rows(
      rows, cols, cols, out, out, scratch, [&](T * strip, T * result, T * work) __attribute__((always_inline)) {
        strip_transform(inverse, psi.cols, strip, result, work);
      });
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
