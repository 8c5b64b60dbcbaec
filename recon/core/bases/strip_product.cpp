#include "recon/core/bases/strip_product.hpp"

#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
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
