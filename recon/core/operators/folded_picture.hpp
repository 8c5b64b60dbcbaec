#pragma once

#include <cstddef>

#include "recon/core/parts/lane_vectors.hpp"
#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {

// The four quadrants of a picture folded on its centre lines, as core/running_sums.hpp wants them.

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

  [[nodiscard]] COMPUEYE_INLINE std::ptrdiff_t in_all_lanes() const {
    std::ptrdiff_t least = count[0];
    for (std::size_t l = 1; l < 4; ++l) least = count[l] < least ? count[l] : least;
    return least;
  }

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

/// Four numbers from `at` on, forward or backward, in that order.
template <class T>
COMPUEYE_INLINE Four<T> load_towards(const T* at, bool backward) {
  if (!backward) return load_four(at);
  return reversed<T>(load_four(at - 3));
}

template <class T>
COMPUEYE_INLINE void add_towards(const Four<T>& v, T* at, bool backward) {
  T* to = backward ? at - 3 : at;
  const Four<T> ordered = backward ? reversed<T>(v) : v;
  store_four<T>(load_four(to) + ordered, to);
}

/// sums[stride * c] = x summed from the centre line outward, for every c of one row of the picture.
template <std::size_t stride, class T>
COMPUEYE_INLINE void sum_row_outward(const Fold& fold, std::ptrdiff_t r, const T* __restrict x, T* __restrict sums) {
  constexpr auto apart = static_cast<std::ptrdiff_t>(stride);
  const FoldedRow row = FoldedRow::of(fold, r);
  Four<T> sum = {};
  std::ptrdiff_t c = 0;
  for (; c + 4 <= row.in_all_lanes(); c += 4) {
    Four<T> pixels[4];
    for (std::size_t l = 0; l < 4; ++l) pixels[l] = load_towards(x + row.first[l] + c * row.step[l], l % 2 == 0);
    transpose<T>(pixels);
    for (std::ptrdiff_t k = 0; k < 4; ++k) {
      sum += pixels[k];
      store_four<T>(sum, sums + apart * (c + k));
    }
  }
  for (; c < fold.half_cols; ++c) {
    Four<T> pixels;
    for (std::size_t l = 0; l < 4; ++l) pixels[l] = c < row.count[l] ? x[row.first[l] + c * row.step[l]] : T(0);
    sum += pixels;
    store_four<T>(sum, sums + apart * c);
  }
}

/// x += sums summed from the outside inward, for one row of the picture.
template <std::size_t stride, class T>
COMPUEYE_INLINE void sum_row_inward(const Fold& fold, std::ptrdiff_t r, const T* __restrict sums, T* __restrict x) {
  constexpr auto apart = static_cast<std::ptrdiff_t>(stride);
  const FoldedRow row = FoldedRow::of(fold, r);
  const std::ptrdiff_t whole = row.in_all_lanes() / 4 * 4;
  Four<T> sum = {};
  std::ptrdiff_t c = fold.half_cols;
  while (c > whole) {
    --c;
    sum += load_four(sums + apart * c);
    for (std::size_t l = 0; l < 4; ++l) {
      if (c < row.count[l]) x[row.first[l] + c * row.step[l]] += sum[l];
    }
  }
  while (c > 0) {
    c -= 4;
    Four<T> rests[4];
    for (std::ptrdiff_t k = 4; k-- > 0;) {
      sum += load_four(sums + apart * (c + k));
      rests[k] = sum;
    }
    transpose<T>(rests);
    for (std::size_t l = 0; l < 4; ++l) add_towards<T>(rests[l], x + row.first[l] + c * row.step[l], l % 2 == 0);
  }
}

/// The same for `count`, 1 or 4, rows r .. of the transposed picture, eight lanes apart and half_cols elements a row:
/// the picture's columns are summed, four of them side by side.
template <std::ptrdiff_t count, class T>
COMPUEYE_INLINE void sum_columns_outward(const Fold& fold, std::ptrdiff_t r, const T* __restrict x,
                                         T* __restrict sums) {
  const FoldedRow row = FoldedRow::of_transposed(fold, r);
  Four<T> sum[4] = {};
  for (std::ptrdiff_t c = 0; c < fold.half_cols; ++c) {
    for (std::size_t l = 0; l < 4; ++l) {
      const T* at = x + row.first[l] + c * row.step[l];
      if constexpr (count == 4) sum[l] += load_towards(at, l < 2);
      if constexpr (count == 1) sum[l][0] += *at;
    }
    Four<T> turned[4] = {sum[0], sum[1], sum[2], sum[3]};
    transpose<T>(turned);
    for (std::ptrdiff_t k = 0; k < count; ++k) store_four<T>(turned[k], sums + 8 * (k * fold.half_cols + c));
  }
}

template <std::ptrdiff_t count, class T>
COMPUEYE_INLINE void sum_columns_inward(const Fold& fold, std::ptrdiff_t r, const T* __restrict sums, T* __restrict x) {
  const FoldedRow row = FoldedRow::of_transposed(fold, r);
  Four<T> sum[4] = {};
  for (std::ptrdiff_t c = fold.half_cols; c-- > 0;) {
    Four<T> turned[4] = {};
    for (std::ptrdiff_t k = 0; k < count; ++k) turned[k] = load_four(sums + 8 * (k * fold.half_cols + c));
    transpose<T>(turned);
    for (std::size_t l = 0; l < 4; ++l) {
      sum[l] += turned[l];
      T* at = x + row.first[l] + c * row.step[l];
      if constexpr (count == 4) add_towards<T>(sum[l], at, l < 2);
      if constexpr (count == 1) *at += sum[l][0];
    }
  }
}

}  // namespace compueye::recon::core
