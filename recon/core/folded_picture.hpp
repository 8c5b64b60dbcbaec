#pragma once

#include <cstddef>

#include "recon/core/multiversion.hpp"

namespace compueye::recon::core {

// The four quadrants of a picture folded on its centre lines, as core/running_sums.hpp wants them.

template <class T>
struct FourLanes;
template <>
struct FourLanes<float> {
  using type = float __attribute__((vector_size(16)));
};
template <>
struct FourLanes<double> {
  using type = double __attribute__((vector_size(32)));
};
template <class T>
using Four = typename FourLanes<T>::type;

struct Fold {
  Fold(std::size_t image_rows, std::size_t image_cols)
      : rows(static_cast<std::ptrdiff_t>(image_rows)),
        cols(static_cast<std::ptrdiff_t>(image_cols)),
        above(rows / 2),
        left(cols / 2),
        half_cols((cols + 1) / 2) {}
  std::ptrdiff_t rows, cols, above, left, half_cols;
};

/// Where lane l's pixels of one folded row lie: pixel c is at first[l] + c * step[l], and there are count[l] of them.
/// An odd picture's centre row and column belong to the lower and the right half.
struct FoldedRow {
  std::ptrdiff_t first[4], step[4], count[4];

  /// Row r of the picture.
  COMPUEYE_INLINE static FoldedRow of(const Fold& f, std::ptrdiff_t r) {
    const std::ptrdiff_t upper = (f.above - 1 - r) * f.cols, lower = (f.above + r) * f.cols;
    const std::ptrdiff_t in_upper = r < f.above ? 1 : 0, in_lower = f.above + r < f.rows ? 1 : 0;
    const std::ptrdiff_t right = f.cols - f.left;
    return {{upper + f.left - 1, upper + f.left, lower + f.left - 1, lower + f.left},
            {-1, 1, -1, 1},
            {in_upper * f.left, in_upper * right, in_lower * f.left, in_lower * right}};
  }

  /// Row r of the transposed picture, which is square with an even side.
  COMPUEYE_INLINE static FoldedRow of_transposed(const Fold& f, std::ptrdiff_t r) {
    const std::ptrdiff_t upper = (f.above - 1) * f.cols, lower = f.above * f.cols;
    const std::ptrdiff_t near = f.left - 1 - r, far = f.left + r;
    return {{upper + near, lower + near, upper + far, lower + far},
            {-f.cols, f.cols, -f.cols, f.cols},
            {f.above, f.above, f.above, f.above}};
  }
};

/// sums[stride * c] = x summed from the centre line outward, for every c.
template <std::size_t stride, class T>
COMPUEYE_INLINE void sum_row_outward(const FoldedRow& row, std::ptrdiff_t count, const T* __restrict x,
                                     T* __restrict sums) {
  Four<T> sum = {};
  for (std::ptrdiff_t c = 0; c < count; ++c) {
    Four<T> pixels;
    for (std::size_t l = 0; l < 4; ++l) pixels[l] = c < row.count[l] ? x[row.first[l] + c * row.step[l]] : T(0);
    sum += pixels;
    __builtin_memcpy(sums + static_cast<std::ptrdiff_t>(stride) * c, &sum, sizeof(sum));
  }
}

/// x += sums summed from the outside inward.
template <std::size_t stride, class T>
COMPUEYE_INLINE void sum_row_inward(const FoldedRow& row, std::ptrdiff_t count, const T* __restrict sums,
                                    T* __restrict x) {
  Four<T> sum = {};
  for (std::ptrdiff_t c = count; c-- > 0;) {
    Four<T> here;
    __builtin_memcpy(&here, sums + static_cast<std::ptrdiff_t>(stride) * c, sizeof(here));
    sum += here;
    for (std::size_t l = 0; l < 4; ++l) {
      if (c < row.count[l]) x[row.first[l] + c * row.step[l]] += sum[l];
    }
  }
}

}  // namespace compueye::recon::core
