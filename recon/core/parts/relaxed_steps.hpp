#pragma once

#include <cstddef>

#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/proximal.hpp"

namespace compueye::recon::core {

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
