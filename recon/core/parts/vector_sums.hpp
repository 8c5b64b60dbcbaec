#pragma once

#include <cstddef>

namespace compueye::recon::core {

/// The frame path's long sums run over 16 lanes: element k goes to lane k mod 16, lanes are then added in the fixed
/// tree 8, 4, 2, 1. Whatever vector width a processor has, the bits are the same.
inline constexpr std::size_t lanes = 16;

/// sum a_k b_k
float dot(const float* a, const float* b, std::size_t n) noexcept;
double dot(const double* a, const double* b, std::size_t n) noexcept;

/// sum a_k x_k, and y_k += a_k * scale in the same pass: one half of a symmetric product. `a` must not overlap y.
float dot_and_accumulate(const float* a, const float* x, float scale, float* y, std::size_t n) noexcept;
double dot_and_accumulate(const double* a, const double* x, double scale, double* y, std::size_t n) noexcept;

/// y_k += a_k * scale
void accumulate(const float* a, float scale, float* y, std::size_t n) noexcept;
void accumulate(const double* a, double scale, double* y, std::size_t n) noexcept;

/// sum |a_k|
float sum_of_magnitudes(const float* a, std::size_t n) noexcept;
double sum_of_magnitudes(const double* a, std::size_t n) noexcept;

/// sum (a_k - b_k)^2
float squared_distance(const float* a, const float* b, std::size_t n) noexcept;
double squared_distance(const double* a, const double* b, std::size_t n) noexcept;

/// True when every a_k is neither NaN nor infinite.
bool all_finite(const float* a, std::size_t n) noexcept;
bool all_finite(const double* a, std::size_t n) noexcept;

}  // namespace compueye::recon::core
