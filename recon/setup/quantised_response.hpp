#pragma once

#include <cstdint>

#include "recon/core/operators/linear_operator.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// The matrix that a lossy operator applies, every entry as it is stored; any other kind: the response itself. Factor,
/// modes, step sizes, norms and the rules for lambda and rho are to be computed from it: a factor of the unrounded
/// matrix inverts another one than the frame path applies, and solvers would end where neither is solved.
/// Quantising twice is quantising once.
///
/// bf16: 8 bits of mantissa, rounding to nearest, ties to even. int8: the row's largest magnitude over 127 times a
/// whole number; a row whose largest entry is below least_row_peak has no scale and becomes blind. Wavelet runs:
/// recon/setup/wavelet_rounding.hpp; a picture that they do not fit stays as it is.
[[nodiscard]] Response quantised(const Response& response, OperatorKind kind);

/// Whether rounding leaves what the rows tell beyond the mean brightness of the picture: ||A - rounded||_F is at most
/// most_rounding of ||A - A 1 1'/N||_F. On an eye whose rows stand on a pedestal the details drown in the rounding of
/// it: objectives double at about .2 in bf16 and .3 in int8.
[[nodiscard]] bool keeps_details(const Response& response, const Response& rounded);
inline constexpr double most_rounding = 0.06;

inline constexpr double least_row_peak = 1e-30;

/// Of a row with this largest magnitude; 0 below least_row_peak.
[[nodiscard]] float int8_scale(double largest) noexcept;
[[nodiscard]] std::int8_t int8_of(double value, float scale) noexcept;

/// The upper half of the nearest bfloat16; numbers below the least normal float are 0.
[[nodiscard]] std::uint16_t bf16_of(double value) noexcept;
[[nodiscard]] float float_of_bf16(std::uint16_t bits) noexcept;

}  // namespace compueye::recon
