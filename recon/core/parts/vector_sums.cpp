#include "recon/core/parts/vector_sums.hpp"

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
COMPUEYE_INLINE T add_lanes(T* sum) {
  for (std::size_t half = lanes / 2; half > 0; half /= 2) {
    for (std::size_t l = 0; l < half; ++l) sum[l] += sum[l + half];
  }
  return sum[0];
}

/// sum[l] += term(l) for every lane. Sixteen doubles are in no register of a processor without vectors: unrolled they
/// would only take more of its stack.
template <class T, class Term>
COMPUEYE_INLINE void add_to_lanes(T* sum, Term term) {
#if defined(COMPUEYE_PLAIN_LANES)
  if constexpr (sizeof(T) == sizeof(double)) {
#pragma GCC unroll 1
    for (std::size_t l = 0; l < lanes; ++l) sum[l] += term(l);
    return;
  }
#endif
  for (std::size_t l = 0; l < lanes; ++l) sum[l] += term(l);
}

template <class T, class Term>
COMPUEYE_INLINE T sum_over_lanes(std::size_t n, Term term) {
  T sum[lanes] = {};
  std::size_t k = 0;
  for (; k + lanes <= n; k += lanes) {
    add_to_lanes(
        sum, [=](std::size_t l) __attribute__((always_inline)) { return term(k + l); });
  }
  for (std::size_t l = 0; k + l < n; ++l) sum[l] += term(k + l);
  return add_lanes(sum);
}

template <class T>
COMPUEYE_INLINE T dot_of(const T* a, const T* b, std::size_t n) {
  return sum_over_lanes<T>(
      n, [=](std::size_t k) __attribute__((always_inline)) { return a[k] * b[k]; });
}

template <class T>
COMPUEYE_INLINE T dot_and_accumulate_of(const T* __restrict a, const T* __restrict x, T scale, T* __restrict y,
                                        std::size_t n) {
  T sum[lanes] = {};
  std::size_t k = 0;
  for (; k + lanes <= n; k += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) {
      sum[l] += a[k + l] * x[k + l];
      y[k + l] += a[k + l] * scale;
    }
  }
  for (std::size_t l = 0; k + l < n; ++l) {
    sum[l] += a[k + l] * x[k + l];
    y[k + l] += a[k + l] * scale;
  }
  return add_lanes(sum);
}

template <class T>
COMPUEYE_INLINE void accumulate_of(const T* __restrict a, T scale, T* __restrict y, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) y[k] += a[k] * scale;
}

template <class T>
COMPUEYE_INLINE T magnitudes_of(const T* a, std::size_t n) {
  return sum_over_lanes<T>(
      n, [=](std::size_t k) __attribute__((always_inline)) { return a[k] < T(0) ? -a[k] : a[k]; });
}

template <class T>
COMPUEYE_INLINE T squared_distance_of(const T* a, const T* b, std::size_t n) {
  return sum_over_lanes<T>(
      n, [=](std::size_t k) __attribute__((always_inline)) {
        const T d = a[k] - b[k];
        return d * d;
      });
}

template <class T>
COMPUEYE_INLINE bool all_finite_of(const T* a, std::size_t n) {
  // 0 * a is 0 for finite a and NaN otherwise; a sum keeps the NaN.
  const T sum = sum_over_lanes<T>(
      n, [=](std::size_t k) __attribute__((always_inline)) { return T(0) * a[k]; });
  return sum == T(0);
}

}  // namespace

COMPUEYE_MULTIVERSION float dot(const float* a, const float* b, std::size_t n) noexcept {
  return dot_of(a, b, n);
}
COMPUEYE_MULTIVERSION double dot(const double* a, const double* b, std::size_t n) noexcept {
  return dot_of(a, b, n);
}

COMPUEYE_MULTIVERSION float dot_and_accumulate(const float* a, const float* x, float scale, float* y,
                                               std::size_t n) noexcept {
  return dot_and_accumulate_of(a, x, scale, y, n);
}
COMPUEYE_MULTIVERSION double dot_and_accumulate(const double* a, const double* x, double scale, double* y,
                                                std::size_t n) noexcept {
  return dot_and_accumulate_of(a, x, scale, y, n);
}

COMPUEYE_MULTIVERSION void accumulate(const float* a, float scale, float* y, std::size_t n) noexcept {
  accumulate_of(a, scale, y, n);
}
COMPUEYE_MULTIVERSION void accumulate(const double* a, double scale, double* y, std::size_t n) noexcept {
  accumulate_of(a, scale, y, n);
}

COMPUEYE_MULTIVERSION float sum_of_magnitudes(const float* a, std::size_t n) noexcept {
  return magnitudes_of(a, n);
}
COMPUEYE_MULTIVERSION double sum_of_magnitudes(const double* a, std::size_t n) noexcept {
  return magnitudes_of(a, n);
}

COMPUEYE_MULTIVERSION float squared_distance(const float* a, const float* b, std::size_t n) noexcept {
  return squared_distance_of(a, b, n);
}
COMPUEYE_MULTIVERSION double squared_distance(const double* a, const double* b, std::size_t n) noexcept {
  return squared_distance_of(a, b, n);
}

COMPUEYE_MULTIVERSION bool all_finite(const float* a, std::size_t n) noexcept {
  return all_finite_of(a, n);
}
COMPUEYE_MULTIVERSION bool all_finite(const double* a, std::size_t n) noexcept {
  return all_finite_of(a, n);
}

}  // namespace compueye::recon::core
