#pragma once

#include "sim/random/random.hpp"

namespace compueye::sim {

/// A Poisson number of the given mean, one draw of 64 bits each; 0 for a mean that is not above 0. Exact (by inversion)
/// below poisson_exact_below; from there on floor of the third-order expansion of the quantile, whose distribution
/// function is off by less than 1e-5 everywhere. Source: Giles, "Algorithm 955: approximation of the inverse Poisson
/// cumulative distribution function", ACM TOMS 42 (2016), equation 6.
[[nodiscard]] double poisson(RandomStream& random, double mean) noexcept;

inline constexpr double poisson_exact_below = 32.0;

}  // namespace compueye::sim
