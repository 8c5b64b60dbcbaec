#include "recon/core/parts/proximal.hpp"

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
COMPUEYE_INLINE void prox_step_of(const T* __restrict x, T* __restrict z, T* __restrict u, std::size_t n, T relaxation,
                                  T threshold, T lo, T hi) {
  const T rest = T(1) - relaxation;
  for (std::size_t k = 0; k < n; ++k) {
    const T t = relaxation * x[k] + rest * z[k] + u[k];
    const T prox = prox_l1_box(t, threshold, lo, hi);
    z[k] = flushed(prox);
    u[k] = flushed(t - prox);
  }
}

template <class T>
COMPUEYE_INLINE void prox_step_of(const T* __restrict x, T* __restrict z, T* __restrict u, std::size_t n, T relaxation,
                                  const T* __restrict thresholds, T lo, T hi) {
  const T rest = T(1) - relaxation;
  for (std::size_t k = 0; k < n; ++k) {
    const T t = relaxation * x[k] + rest * z[k] + u[k];
    const T prox = prox_l1_box(t, thresholds[k], lo, hi);
    z[k] = flushed(prox);
    u[k] = flushed(t - prox);
  }
}

template <class T>
COMPUEYE_INLINE void subtract_of(const T* __restrict a, const T* __restrict b, T* __restrict out, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) out[k] = a[k] - b[k];
}

template <class T>
COMPUEYE_INLINE void blend_of(const T* __restrict a, const T* __restrict b, T share, T* __restrict out, std::size_t n) {
  const T rest = T(1) - share;
  for (std::size_t k = 0; k < n; ++k) out[k] = share * out[k] + rest * (a[k] - b[k]);
}

template <class T>
COMPUEYE_INLINE void flush_of(T* a, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) a[k] = flushed(a[k]);
}

}  // namespace

COMPUEYE_MULTIVERSION void relaxed_prox_step(const float* x, float* z, float* u, std::size_t n, float relaxation,
                                             float threshold, float lo, float hi) noexcept {
  prox_step_of(x, z, u, n, relaxation, threshold, lo, hi);
}
COMPUEYE_MULTIVERSION void relaxed_prox_step(const double* x, double* z, double* u, std::size_t n, double relaxation,
                                             double threshold, double lo, double hi) noexcept {
  prox_step_of(x, z, u, n, relaxation, threshold, lo, hi);
}

COMPUEYE_MULTIVERSION void relaxed_prox_step(const float* x, float* z, float* u, std::size_t n, float relaxation,
                                             const float* thresholds, float lo, float hi) noexcept {
  prox_step_of(x, z, u, n, relaxation, thresholds, lo, hi);
}
COMPUEYE_MULTIVERSION void relaxed_prox_step(const double* x, double* z, double* u, std::size_t n, double relaxation,
                                             const double* thresholds, double lo, double hi) noexcept {
  prox_step_of(x, z, u, n, relaxation, thresholds, lo, hi);
}

COMPUEYE_MULTIVERSION void subtract(const float* a, const float* b, float* out, std::size_t n) noexcept {
  subtract_of(a, b, out, n);
}
COMPUEYE_MULTIVERSION void subtract(const double* a, const double* b, double* out, std::size_t n) noexcept {
  subtract_of(a, b, out, n);
}

COMPUEYE_MULTIVERSION void blend_difference(const float* a, const float* b, float share, float* out,
                                            std::size_t n) noexcept {
  blend_of(a, b, share, out, n);
}
COMPUEYE_MULTIVERSION void blend_difference(const double* a, const double* b, double share, double* out,
                                            std::size_t n) noexcept {
  blend_of(a, b, share, out, n);
}

COMPUEYE_MULTIVERSION void flush_tiny(float* a, std::size_t n) noexcept {
  flush_of(a, n);
}
COMPUEYE_MULTIVERSION void flush_tiny(double* a, std::size_t n) noexcept {
  flush_of(a, n);
}

}  // namespace compueye::recon::core
