#pragma once

#include <cstddef>

#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

// The 9/7 wavelet of Cohen, Daubechies & Feauveau (1992) as the four lifting steps of Daubechies & Sweldens (1998),
// section 7.7, with its picture mirrored at both ends, along the rows of a strip (core/bases/strip.hpp).

inline constexpr double lifting_steps[] = {-1.586134342059924, -0.052980118572961, 0.882911075530934,
                                           0.443506852043971};
/// Brings averages and details close to an orthonormal basis.
inline constexpr double lifting_scale = 1.149604398860241;

/// Row i of a strip += c (wl row i-1 + wr row i+1).
template <class T>
COMPUEYE_INLINE void lift_row(T* x, std::size_t i, std::size_t left, T wl, std::size_t right, T wr, T c) {
  T* to = x + i * lanes;
  const T *l = x + left * lanes, *r = x + right * lanes;
  for (std::size_t k = 0; k < lanes; ++k) to[k] += c * (wl * l[k] + wr * r[k]);
}

/// One step: every second of `n` >= 2 rows, from `parity` on, gains c times the sum of its two neighbours. At the ends
/// the one neighbour counts twice; `transposed` is the step's transpose, where the end row itself counts twice.
template <bool transposed, class T>
COMPUEYE_INLINE void lift(T* __restrict x, std::size_t n, std::size_t parity, T c) {
  const auto weight = [&](std::size_t from) { return transposed && (from == 0 || from + 1 == n) ? T(2) : T(1); };
  const auto at_end = [&](std::size_t i) __attribute__((always_inline)) {
    if (i == 0) return lift_row(x, i, 1, T(0), 1, transposed ? weight(1) : T(2), c);
    if (i + 1 == n) return lift_row(x, i, n - 2, transposed ? weight(n - 2) : T(2), n - 2, T(0), c);
    lift_row(x, i, i - 1, weight(i - 1), i + 1, weight(i + 1), c);
  };
  at_end(parity);
  std::size_t i = parity + 2;
  for (; i + 2 < n; i += 2) {
    T* to = x + i * lanes;
    const T *above = to - lanes, *below = to + lanes;
    for (std::size_t k = 0; k < lanes; ++k) to[k] += c * (above[k] + below[k]);
  }
  for (; i < n; i += 2) at_end(i);
}

}  // namespace compueye::recon::core
