#pragma once

#include <cstddef>

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {

/// The proximal map of  threshold * |x| + indicator(lo <= x <= hi), one number at a time: soft threshold, then clip.
/// Right for lo <= 0 <= hi and for lo > 0 alike, because the sum is convex on the line. lo and hi may be infinite.
template <class T>
[[nodiscard]] constexpr T prox_l1_box(T t, T threshold, T lo, T hi) noexcept {
  const T up = t - threshold, down = t + threshold;
  const T shrunk = (up > T(0) ? up : T(0)) + (down < T(0) ? down : T(0));
  const T above = shrunk > lo ? shrunk : lo;
  return above < hi ? above : hi;
}

/// The nearest number to q of at most this magnitude: the proximal map of the conjugate of bound * |x|.
template <class T>
[[nodiscard]] constexpr T within(T q, T bound) noexcept {
  const T above = q > -bound ? q : -bound;
  return above < bound ? above : bound;
}

/// One over-relaxed ADMM half-step on a block of n variables (Boyd et al. 2011, eq. 3.19 with 3.1.1's scaled dual):
///   t = relaxation * x + (1 - relaxation) * z + u;  z = prox(t);  u = t - z
/// Values of u below `tiny` become zero, so that no dual decays into subnormal numbers.
void relaxed_prox_step(const float* x, float* z, float* u, std::size_t n, float relaxation, float threshold, float lo,
                       float hi) noexcept;
void relaxed_prox_step(const double* x, double* z, double* u, std::size_t n, double relaxation, double threshold,
                       double lo, double hi) noexcept;

/// The same with a threshold for each variable.
void relaxed_prox_step(const float* x, float* z, float* u, std::size_t n, float relaxation, const float* thresholds,
                       float lo, float hi) noexcept;
void relaxed_prox_step(const double* x, double* z, double* u, std::size_t n, double relaxation,
                       const double* thresholds, double lo, double hi) noexcept;

/// out = (a - b), the point around which the next quadratic step is taken.
void subtract(const float* a, const float* b, float* out, std::size_t n) noexcept;
void subtract(const double* a, const double* b, double* out, std::size_t n) noexcept;

/// out = share * out + (1 - share) * (a - b)
void blend_difference(const float* a, const float* b, float share, float* out, std::size_t n) noexcept;
void blend_difference(const double* a, const double* b, double share, double* out, std::size_t n) noexcept;

/// Magnitudes below this are noughts to the frame path. White is 1 and an LSB at least 1e-6 of it, so nothing is lost,
/// and products with entries of A above 1e-13 stay far above the smallest normal float32.
inline constexpr double tiny = 1e-20;

template <class T>
[[nodiscard]] constexpr T flushed(T value) noexcept {
  const T limit = static_cast<T>(tiny);
  return (value < limit && value > -limit) ? T(0) : value;
}

void flush_tiny(float* a, std::size_t n) noexcept;
void flush_tiny(double* a, std::size_t n) noexcept;

/// The passes of an over-relaxed primal-dual iteration (Condat 2013, "A primal-dual splitting method for convex
/// optimization involving Lipschitzian, proximable and linear composite terms", algorithm 3.1), each reading its
/// vectors once. Magnitudes below `tiny` (core/proximal.hpp) become zero.

/// p = prox(x - step g) with a soft threshold and bounds, as prox_l1_box(); ahead = 2 p - x; x += relaxation (p - x);
/// and g = p, which nobody needs until the last iteration, whose picture it is.
void descend(float* g, float step, float threshold, float lo, float hi, float relaxation, float* x, float* ahead,
             std::size_t n) noexcept;
void descend(double* g, double step, double threshold, double lo, double hi, double relaxation, double* x,
             double* ahead, std::size_t n) noexcept;

/// r, which was A x, becomes y - r + u; u alone where a sample has no weight.
void add_dual_to_residual(const float* y, const float* weights, const float* u, float* r, std::size_t n) noexcept;
void add_dual_to_residual(const double* y, const double* weights, const double* u, double* r, std::size_t n) noexcept;

/// u -= relaxation * step
void step_down(const float* step, float relaxation, float* u, std::size_t n) noexcept;
void step_down(const double* step, double relaxation, double* u, std::size_t n) noexcept;

/// How a dual of lambda ||Psi x||_1 moves: q += relaxation (clip(q + step c, +-bound) - q) with c = Psi x.
template <class T>
struct Ascent {
  T step = T(0);
  T bound = T(0);  ///< lambda
  T relaxation = T(1);

  [[nodiscard]] COMPUEYE_INLINE T moved(T q, T c) const noexcept {
    return flushed(q + relaxation * (within(q + step * c, bound) - q));
  }
};

void ascend(const float* c, const Ascent<float>& ascent, float* q, std::size_t n) noexcept;
void ascend(const double* c, const Ascent<double>& ascent, double* q, std::size_t n) noexcept;

}  // namespace compueye::recon::core
