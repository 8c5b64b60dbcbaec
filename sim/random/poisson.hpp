#pragma once

#include "sim/random/random.hpp"

namespace compueye::sim {

inline constexpr double poisson_exact_below = 32.0;

/// The Poisson number of that mean whose share of smaller ones is that of a standard normal's below `w`: floor of the
/// third-order expansion of the quantile. For means from poisson_exact_below on its distribution function is off by
/// less than 1e-5 everywhere. Source: Giles, "Algorithm 955: approximation of the inverse Poisson cumulative
/// distribution function", ACM TOMS 42 (2016), equation 6.
[[nodiscard]] double poisson_at(double w, double mean) noexcept;

/// A Poisson number of the given mean, one draw of 64 bits each; 0 for a mean that is not above 0. Exact (by inversion)
/// below poisson_exact_below, poisson_at of a normal draw from there on.
[[nodiscard]] double poisson(RandomStream& random, double mean) noexcept;

}  // namespace compueye::sim
