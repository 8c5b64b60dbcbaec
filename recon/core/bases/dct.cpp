#include "recon/core/bases/dct.hpp"

#include "recon/core/bases/strip.hpp"
#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

/// Sums of mirrored rows stay in the first half of `strip`, their differences go to `difference`.
template <class T>
COMPUEYE_INLINE void fold(T* strip, T* difference, std::size_t n) {
  for (std::size_t r = 0; r < n / 2; ++r) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const T a = strip[r * lanes + l], b = strip[(n - 1 - r) * lanes + l];
      strip[r * lanes + l] = a + b;
      difference[r * lanes + l] = a - b;
    }
  }
}

/// out (half rows of even part) and `odd` become the 2 * half rows that fold() came from, transposed.
template <class T>
COMPUEYE_INLINE void unfold(T* out, const T* odd, std::size_t half) {
  for (std::size_t r = 0; r < half; ++r) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const T even = out[r * lanes + l], difference = odd[r * lanes + l];
      out[r * lanes + l] = even + difference;
      out[(2 * half - 1 - r) * lanes + l] = even - difference;
    }
  }
}

/// DCT-II of n rows by halving alone. `strip` is used up, `work` takes n / 2 rows.
template <class T>
COMPUEYE_INLINE void halving_forward(const T* c, std::size_t n, T* strip, T* out, T* work) {
  std::size_t stride = 1;
  while (n % 2 == 0) {
    fold(strip, work, n);
    n /= 2;
    strip_product(c, n, work, out + stride * lanes, 2 * stride);
    c += n * n;
    stride *= 2;
  }
  strip_product(c, n, strip, out, stride);
}

/// The transpose of halving_forward: levels undone from the innermost outward. `work` takes n rows.
template <class T>
COMPUEYE_INLINE void halving_inverse(const T* c, std::size_t length, const T* in, T* out, T* work) {
  std::size_t n = length;
  std::size_t stride = 1;
  c += DctTable<T>::halving_size(length);
  while (n % 2 == 0) {
    n /= 2;
    stride *= 2;
  }
  c -= n * n;
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < lanes; ++l) work[k * lanes + l] = in[k * stride * lanes + l];
  }
  strip_product_transposed(c, n, work, out);
  while (n < length) {
    const std::size_t odd_stride = stride;
    stride /= 2;
    c -= n * n;
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t l = 0; l < lanes; ++l) work[k * lanes + l] = in[(k * odd_stride + stride) * lanes + l];
    }
    strip_product_transposed(c, n, work, work + n * lanes);
    unfold(out, work + n * lanes, n);
    n *= 2;
  }
}

/// Coefficients of the DCT-IV of m rows of `difference`, to every second row of `out` from row `stride` on. `pair` and
/// `work` take m and 3/2 m rows; `difference` may be the first m of work.
///
/// With c = cos and s = sin of pi (2r+1) / (4m), u_r = c x_r + s x_(m-1-r) and v_r = (-1)^r (s x_r - c x_(m-1-r)):
/// the sum and the difference of coefficients 2k-1 and 2k are twice the DCT-II of u at k and of v at m/2-k.
template <class T>
COMPUEYE_STAGE void rotated_forward(const T* rotation, const T* halving, std::size_t m, const T* difference, T* pair,
                                    T* out, std::size_t stride, T* work) {
  const std::size_t h = m / 2;
  T *u = pair, *v = pair + h * lanes;
  for (std::size_t r = 0; r < h; ++r) {
    const T c = rotation[r], s = rotation[h + r], sign = r % 2 == 0 ? T(1) : T(-1);
    for (std::size_t l = 0; l < lanes; ++l) {
      const T a = difference[r * lanes + l], b = difference[(m - 1 - r) * lanes + l];
      u[r * lanes + l] = c * a + s * b;
      v[r * lanes + l] = sign * (s * a - c * b);
    }
  }
  T *of_u = work, *of_v = work + h * lanes, *inner = work + m * lanes;
  halving_forward(halving, h, u, of_u, inner);
  halving_forward(halving, h, v, of_v, inner);
  const T root_two = T(1.4142135623730951);
  T* first = out + stride * lanes;
  for (std::size_t l = 0; l < lanes; ++l) {
    first[l] = root_two * of_u[l];
    first[2 * stride * (m - 1) * lanes + l] = root_two * of_v[l];
  }
  for (std::size_t k = 1; k < h; ++k) {
    T *even = first + 2 * stride * (2 * k) * lanes, *odd = first + 2 * stride * (2 * k - 1) * lanes;
    for (std::size_t l = 0; l < lanes; ++l) {
      const T a = of_u[k * lanes + l], b = of_v[(h - k) * lanes + l];
      even[l] = a - b;
      odd[l] = a + b;
    }
  }
}

/// The transpose of rotated_forward: m rows of `difference` from coefficients that are 2 * stride rows apart, the first
/// at `in`. `difference` is the first m of `work`, which takes 5/2 m rows.
template <class T>
COMPUEYE_STAGE void rotated_inverse(const T* rotation, const T* halving, std::size_t m, const T* in, std::size_t apart,
                                    T* work) {
  const std::size_t h = m / 2;
  T *of_u = work, *of_v = work + h * lanes;
  const T root_two = T(1.4142135623730951);
  for (std::size_t l = 0; l < lanes; ++l) {
    of_u[l] = root_two * in[l];
    of_v[l] = root_two * in[apart * (m - 1) * lanes + l];
  }
  for (std::size_t k = 1; k < h; ++k) {
    const T *even = in + apart * (2 * k) * lanes, *odd = in + apart * (2 * k - 1) * lanes;
    for (std::size_t l = 0; l < lanes; ++l) {
      of_u[k * lanes + l] = odd[l] + even[l];
      of_v[(h - k) * lanes + l] = odd[l] - even[l];
    }
  }
  T *u = work + m * lanes, *v = u + h * lanes, *inner = v + h * lanes;
  halving_inverse(halving, h, of_u, u, inner);
  halving_inverse(halving, h, of_v, v, inner);
  for (std::size_t r = 0; r < h; ++r) {
    const T c = rotation[r], s = rotation[h + r], sign = r % 2 == 0 ? T(1) : T(-1);
    for (std::size_t l = 0; l < lanes; ++l) {
      const T a = u[r * lanes + l], b = sign * v[r * lanes + l];
      work[r * lanes + l] = c * a + s * b;
      work[(m - 1 - r) * lanes + l] = s * a - c * b;
    }
  }
}

/// strip (length rows, used up) -> out (length rows); `work` takes two times length rows.
template <class T>
COMPUEYE_STAGE void strip_forward(const DctTable<T>& table, T* strip, T* __restrict out, T* work) {
  const T* rotation = table.values;
  std::size_t n = table.length;
  std::size_t stride = 1;
  while (n % 2 == 0) {
    const std::size_t half = n / 2;
    fold(strip, work, n);
    if (DctTable<T>::rotated(half)) {
      rotated_forward(rotation, table.halving(half / 2), half, work, strip + half * lanes, out, stride, work);
      rotation += half;
    } else {
      strip_product(table.halving(n), half, work, out + stride * lanes, 2 * stride);
    }
    n = half;
    stride *= 2;
  }
  strip_product(table.halving(n), n, strip, out, stride);
}

/// The transpose of strip_forward: levels undone from the innermost outward.
template <class T>
COMPUEYE_STAGE void strip_inverse(const DctTable<T>& table, const T* __restrict strip, T* __restrict out, T* work) {
  const T* rotation = table.values;
  std::size_t n = table.length;
  std::size_t stride = 1;
  while (n % 2 == 0) {
    n /= 2;
    stride *= 2;
    rotation += DctTable<T>::rotated(n) ? n : 0;
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < lanes; ++l) work[k * lanes + l] = strip[k * stride * lanes + l];
  }
  strip_product_transposed(table.halving(n), n, work, out);
  while (n < table.length) {
    const std::size_t apart = stride;
    stride /= 2;
    const T* odd = work;
    if (DctTable<T>::rotated(n)) {
      rotation -= n;
      rotated_inverse(rotation, table.halving(n / 2), n, strip + stride * lanes, apart, work);
    } else {
      for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t l = 0; l < lanes; ++l) work[k * lanes + l] = strip[(k * apart + stride) * lanes + l];
      }
      strip_product_transposed(table.halving(2 * n), n, work, work + n * lanes);
      odd = work + n * lanes;
    }
    unfold(out, odd, n);
    n *= 2;
  }
}

/// One pass over strips of columns or of rows, in either direction or there and back by way of a dual in strips.
template <class T>
struct Pass {
  bool columns = false;
  bool forward = false;
  bool inverse = false;
  T* dual = nullptr;
  Ascent<T> ascent = {};
};

/// `strip` -> `result`
template <class T>
COMPUEYE_INLINE void transform_strip(const Pass<T>& pass, const DctTable<T>& table, T* strip, T* result, T* work,
                                     std::size_t first) {
  if (pass.forward) strip_forward(table, strip, result, work);
  const T* back = strip;
  if (pass.dual != nullptr) {
    T* dual = pass.dual + first;
    const Ascent<T> ascent = pass.ascent;
    for (std::size_t k = 0; k < table.length * lanes; ++k) dual[k] = ascent.moved(dual[k], result[k]);
    back = dual;
  }
  if (pass.inverse) strip_inverse(table, back, result, work);
}

template <class T>
COMPUEYE_INLINE void transform_strips(const Pass<T>& pass, const Dct2d<T>& psi, const T* in, T* out, T* scratch,
                                      std::size_t begin, std::size_t end) {
  const std::size_t rows = psi.rows.length, cols = psi.cols.length;
  const DctTable<T>& table = pass.columns ? psi.rows : psi.cols;
  const std::size_t size = table.length * lanes;
  T *strip = scratch, *result = scratch + size, *work = scratch + 2 * size;
  for (std::size_t s = begin; s < end; ++s) {
    const std::size_t width = strip_width(s, pass.columns ? cols : rows), at = s * lanes * (pass.columns ? 1 : cols);
    if (pass.columns) {
      columns_to_strip(in + at, rows, cols, width, strip);
    } else {
      rows_to_strip(in + at, width, cols, cols, strip);
    }
    transform_strip(pass, table, strip, result, work, s * size);
    if (pass.columns) {
      strip_to_columns(result, rows, cols, width, out + at);
    } else {
      strip_to_rows(result, width, cols, cols, out + at);
    }
  }
}

COMPUEYE_MULTIVERSION void do_strips(const Pass<float>& pass, const Dct2d<float>& psi, const float* in, float* out,
                                     float* scratch, std::size_t begin, std::size_t end) noexcept {
  transform_strips(pass, psi, in, out, scratch, begin, end);
}
// Double is for set-up and checks: clones of the products by matrices, which most of the time goes into, are enough.
void do_strips(const Pass<double>& pass, const Dct2d<double>& psi, const double* in, double* out, double* scratch,
               std::size_t begin, std::size_t end) noexcept {
  transform_strips(pass, psi, in, out, scratch, begin, end);
}

template <class T>
void share_pass(const Pass<T>& pass, const Dct2d<T>& psi, const T* in, T* out, T* scratch) noexcept {
  const std::size_t rows = psi.rows.length, cols = psi.cols.length;
  const std::size_t apart = dct_scratch_size(rows, cols);
  psi.crew.share_from_middle(strips_of(pass.columns ? cols : rows), rows * cols,
                             [&](std::size_t worker, std::size_t begin, std::size_t end) {
                               do_strips(pass, psi, in, out, scratch + worker * apart, begin, end);
                             });
}

template <class T>
void forward_of(const Dct2d<T>& psi, const T* in, T* out, T* scratch) noexcept {
  share_pass<T>({.columns = true, .forward = true}, psi, in, out, scratch);
  share_pass<T>({.forward = true}, psi, out, out, scratch);
}

template <class T>
void inverse_of(const Dct2d<T>& psi, const T* in, T* out, T* scratch) noexcept {
  share_pass<T>({.inverse = true}, psi, in, out, scratch);
  share_pass<T>({.columns = true, .inverse = true}, psi, out, out, scratch);
}

template <class T>
void ascend_of(const Dct2d<T>& psi, const Ascent<T>& ascent, const T* in, T* dual, T* out, T* scratch) noexcept {
  share_pass<T>({.columns = true, .forward = true}, psi, in, out, scratch);
  share_pass<T>({.forward = true, .inverse = true, .dual = dual, .ascent = ascent}, psi, out, out, scratch);
  share_pass<T>({.columns = true, .inverse = true}, psi, out, out, scratch);
}

}  // namespace

void dct_forward(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept {
  forward_of(psi, in, out, scratch);
}
void dct_forward(const Dct2d<double>& psi, const double* in, double* out, double* scratch) noexcept {
  forward_of(psi, in, out, scratch);
}
void dct_inverse(const Dct2d<float>& psi, const float* in, float* out, float* scratch) noexcept {
  inverse_of(psi, in, out, scratch);
}
void dct_inverse(const Dct2d<double>& psi, const double* in, double* out, double* scratch) noexcept {
  inverse_of(psi, in, out, scratch);
}
void dct_ascend(const Dct2d<float>& psi, const Ascent<float>& ascent, const float* in, float* dual, float* out,
                float* scratch) noexcept {
  ascend_of(psi, ascent, in, dual, out, scratch);
}
void dct_ascend(const Dct2d<double>& psi, const Ascent<double>& ascent, const double* in, double* dual, double* out,
                double* scratch) noexcept {
  ascend_of(psi, ascent, in, dual, out, scratch);
}

}  // namespace compueye::recon::core
