#include "recon/core/relaxed_steps.hpp"

#include "recon/core/multiversion.hpp"
#include "recon/core/proximal.hpp"

namespace compueye::recon::core {
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
COMPUEYE_INLINE void ascend_of(const T* __restrict c, T step, T bound, T relaxation, T* __restrict q, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    const T dual = within(q[k] + step * c[k], bound);
    q[k] = flushed(q[k] + relaxation * (dual - q[k]));
  }
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
COMPUEYE_MULTIVERSION void ascend(const float* c, float step, float bound, float relaxation, float* q,
                                  std::size_t n) noexcept {
  ascend_of(c, step, bound, relaxation, q, n);
}
COMPUEYE_MULTIVERSION void ascend(const double* c, double step, double bound, double relaxation, double* q,
                                  std::size_t n) noexcept {
  ascend_of(c, step, bound, relaxation, q, n);
}

}  // namespace compueye::recon::core
