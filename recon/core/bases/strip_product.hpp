#pragma once

#include <cstddef>

namespace compueye::recon::core {

// Functions of their own, not inlined like the rest of a transform: a dozen places call them, and a copy for each
// place, processor level and precision took the compiler longer than all other of recon/core.

/// Strip row k * out_stride of `out` = sum_r c[k * n + r] (strip row r of `in`), for k < n; the strips do not overlap.
void strip_product(const float* c, std::size_t n, const float* in, float* out, std::size_t out_stride) noexcept;
void strip_product(const double* c, std::size_t n, const double* in, double* out, std::size_t out_stride) noexcept;

/// The same by c', row by row: strip row k of `out` = sum_r c[r * n + k] (strip row r of `in`).
void strip_product_transposed(const float* c, std::size_t n, const float* in, float* out) noexcept;
void strip_product_transposed(const double* c, std::size_t n, const double* in, double* out) noexcept;

}  // namespace compueye::recon::core
