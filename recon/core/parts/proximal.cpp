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

namespace {

template <class T>
COMPUEYE_INLINE void descend_of(T* __restrict g, T step, T threshold, T lo, T hi, T relaxation, T* __restrict x,
                                T* __restrict ahead, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    const T before = x[k];
    const T p = prox_l1_box(before - step * g[k], threshold, lo, hi);
    g[k] = flushed(p);
    ahead[k] = flushed(T(2) * p - before);
    x[k] = flushed(before + relaxation * (p - before));
  }
}

template <class T>
COMPUEYE_INLINE void ascend_of(const T* __restrict c, const Ascent<T> ascent, T* __restrict q, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) q[k] = ascent.moved(q[k], c[k]);
}

template <class T>
COMPUEYE_INLINE void add_dual_of(const T* __restrict y, const T* __restrict weights, const T* __restrict u,
                                 T* __restrict r, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const T residual = y[i] - r[i];
    r[i] = flushed((weights[i] > T(0) ? residual : T(0)) + u[i]);
  }
}

template <class T>
COMPUEYE_INLINE void step_down_of(const T* __restrict step, T relaxation, T* __restrict u, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) u[i] = flushed(u[i] - relaxation * step[i]);
}

}  // namespace

COMPUEYE_MULTIVERSION void descend(float* g, float step, float threshold, float lo, float hi, float relaxation,
                                   float* x, float* ahead, std::size_t n) noexcept {
  descend_of(g, step, threshold, lo, hi, relaxation, x, ahead, n);
}
COMPUEYE_MULTIVERSION void descend(double* g, double step, double threshold, double lo, double hi, double relaxation,
                                   double* x, double* ahead, std::size_t n) noexcept {
  descend_of(g, step, threshold, lo, hi, relaxation, x, ahead, n);
}
COMPUEYE_MULTIVERSION void ascend(const float* c, const Ascent<float>& ascent, float* q, std::size_t n) noexcept {
  ascend_of(c, ascent, q, n);
}
COMPUEYE_MULTIVERSION void ascend(const double* c, const Ascent<double>& ascent, double* q, std::size_t n) noexcept {
  ascend_of(c, ascent, q, n);
}

COMPUEYE_MULTIVERSION void add_dual_to_residual(const float* y, const float* weights, const float* u, float* r,
                                                std::size_t n) noexcept {
  add_dual_of(y, weights, u, r, n);
}
COMPUEYE_MULTIVERSION void add_dual_to_residual(const double* y, const double* weights, const double* u, double* r,
                                                std::size_t n) noexcept {
  add_dual_of(y, weights, u, r, n);
}
COMPUEYE_MULTIVERSION void step_down(const float* step, float relaxation, float* u, std::size_t n) noexcept {
  step_down_of(step, relaxation, u, n);
}
COMPUEYE_MULTIVERSION void step_down(const double* step, double relaxation, double* u, std::size_t n) noexcept {
  step_down_of(step, relaxation, u, n);
}

}  // namespace compueye::recon::core
