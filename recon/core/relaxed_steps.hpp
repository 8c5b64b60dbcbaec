#pragma once

#include <cstddef>

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

/// q += relaxation (clip(q + step c, +-bound) - q)
void ascend(const float* c, float step, float bound, float relaxation, float* q, std::size_t n) noexcept;
void ascend(const double* c, double step, double bound, double relaxation, double* q, std::size_t n) noexcept;

}  // namespace compueye::recon::core
