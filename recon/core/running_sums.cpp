#include "recon/core/running_sums.hpp"

#include "recon/core/multiversion.hpp"

namespace compueye::recon::core {
namespace {

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

/// Lane l of the result is lane l ^ flip of v.
template <std::size_t flip, class V>
COMPUEYE_INLINE V flipped(V v) {
  if constexpr (flip == 0) return v;
  if constexpr (flip == 1) return __builtin_shufflevector(v, v, 1, 0, 3, 2);
  if constexpr (flip == 2) return __builtin_shufflevector(v, v, 2, 3, 0, 1);
  if constexpr (flip == 3) return __builtin_shufflevector(v, v, 3, 2, 1, 0);
}

/// Where the four pixels of element (r, c) stand in the picture, or -1: an odd picture's centre row and column belong
/// to the lower and the right half.
struct Fold {
  template <class T>
  explicit Fold(const RunningSums<T>& a)
      : above(static_cast<std::ptrdiff_t>(a.image_rows / 2)),
        left(static_cast<std::ptrdiff_t>(a.image_cols / 2)),
        rows(static_cast<std::ptrdiff_t>(a.image_rows)),
        cols(static_cast<std::ptrdiff_t>(a.image_cols)) {}
  std::ptrdiff_t above, left, rows, cols;
};

template <class T>
COMPUEYE_INLINE void sum_outward(const RunningSums<T>& a, const T* __restrict x, Four<T>* __restrict sums) {
  const Fold fold(a);
  const auto half_rows = static_cast<std::ptrdiff_t>(a.half_rows()),
             half_cols = static_cast<std::ptrdiff_t>(a.half_cols());
  for (std::ptrdiff_t r = 0; r < half_rows; ++r) {
    const bool has_upper = r < fold.above, has_lower = fold.above + r < fold.rows;
    const T* upper = x + (fold.above - 1 - r) * fold.cols;
    const T* lower = x + (fold.above + r) * fold.cols;
    Four<T> sum = {};
    for (std::ptrdiff_t c = 0; c < half_cols; ++c) {
      const bool has_left = c < fold.left, has_right = fold.left + c < fold.cols;
      const std::ptrdiff_t at_left = fold.left - 1 - c, at_right = fold.left + c;
      const Four<T> pixels = {
          has_upper && has_left ? upper[at_left] : T(0), has_upper && has_right ? upper[at_right] : T(0),
          has_lower && has_left ? lower[at_left] : T(0), has_lower && has_right ? lower[at_right] : T(0)};
      sum += pixels;
      sums[r * half_cols + c] = sum;
    }
  }
}

template <class T>
COMPUEYE_INLINE void sum_inward(const RunningSums<T>& a, const Four<T>* __restrict sums, T* __restrict x) {
  const Fold fold(a);
  const auto half_rows = static_cast<std::ptrdiff_t>(a.half_rows()),
             half_cols = static_cast<std::ptrdiff_t>(a.half_cols());
  for (std::ptrdiff_t r = 0; r < half_rows; ++r) {
    const bool has_upper = r < fold.above, has_lower = fold.above + r < fold.rows;
    T* upper = x + (fold.above - 1 - r) * fold.cols;
    T* lower = x + (fold.above + r) * fold.cols;
    Four<T> sum = {};
    for (std::ptrdiff_t c = half_cols; c-- > 0;) {
      const bool has_left = c < fold.left, has_right = fold.left + c < fold.cols;
      const std::ptrdiff_t at_left = fold.left - 1 - c, at_right = fold.left + c;
      sum += sums[r * half_cols + c];
      if (has_upper && has_left) upper[at_left] += sum[0];
      if (has_upper && has_right) upper[at_right] += sum[1];
      if (has_lower && has_left) lower[at_left] += sum[2];
      if (has_lower && has_right) lower[at_right] += sum[3];
    }
  }
}

/// Sum of difference times running sum over taps begin .. end-1. Four partial sums, so that one addition need not wait
/// for the one before.
template <class T>
COMPUEYE_INLINE Four<T> taps_of_four(const RunningSums<T>& a, const Four<T>* sums, std::size_t begin, std::size_t end) {
  Four<T> part[4] = {};
  std::size_t k = begin;
  for (; k + 4 <= end; k += 4) {
    for (std::size_t p = 0; p < 4; ++p) part[p] += a.difference[k + p] * sums[a.element[k + p]];
  }
  for (std::size_t p = 0; k + p < end; ++p) part[p] += a.difference[k + p] * sums[a.element[k + p]];
  return (part[0] + part[1]) + (part[2] + part[3]);
}

template <class T>
COMPUEYE_INLINE void forward_symmetric(const RunningSums<T>& a, const Four<T>* sums, T* y) {
  for (std::size_t t = 0; t < a.tables; ++t) {
    const std::uint32_t* first = a.first + 4 * t;
    Four<T> rows = taps_of_four(a, sums, first[0], first[1]);
    rows += flipped<1>(taps_of_four(a, sums, first[1], first[2]));
    rows += flipped<2>(taps_of_four(a, sums, first[2], first[3]));
    rows += flipped<3>(taps_of_four(a, sums, first[3], first[4]));
    for (std::size_t l = 0; l < 4; ++l) {
      if (a.row[4 * t + l] >= 0) y[a.row[4 * t + l]] = rows[l];
    }
  }
}

template <class T>
COMPUEYE_INLINE void adjoint_symmetric(const RunningSums<T>& a, const T* y, Four<T>* sums) {
  for (std::size_t t = 0; t < a.tables; ++t) {
    const std::uint32_t* first = a.first + 4 * t;
    Four<T> rows = {};
    for (std::size_t l = 0; l < 4; ++l) {
      if (a.row[4 * t + l] >= 0) rows[l] = y[a.row[4 * t + l]];
    }
    const Four<T> lanes[4] = {rows, flipped<1>(rows), flipped<2>(rows), flipped<3>(rows)};
    for (std::size_t q = 0; q < 4; ++q) {
      for (std::size_t k = first[q]; k < first[q + 1]; ++k) sums[a.element[k]] += a.difference[k] * lanes[q];
    }
  }
}

template <class T>
COMPUEYE_INLINE T taps_of_one(const RunningSums<T>& a, const T* sums, std::size_t begin, std::size_t end) {
  T part[4] = {};
  std::size_t k = begin;
  for (; k + 4 <= end; k += 4) {
    for (std::size_t p = 0; p < 4; ++p) part[p] += a.difference[k + p] * sums[4 * std::size_t{a.element[k + p]}];
  }
  for (std::size_t p = 0; k + p < end; ++p) part[p] += a.difference[k + p] * sums[4 * std::size_t{a.element[k + p]}];
  return (part[0] + part[1]) + (part[2] + part[3]);
}

template <class T>
COMPUEYE_INLINE void forward_of(const RunningSums<T>& a, const T* x, T* y, T* scratch) {
  auto* sums = reinterpret_cast<Four<T>*>(scratch);
  sum_outward(a, x, sums);
  if (a.symmetric) return forward_symmetric(a, sums, y);
  for (std::size_t t = 0; t < a.tables; ++t) {
    T sum = T(0);
    for (std::size_t q = 0; q < 4; ++q) sum += taps_of_one(a, scratch + q, a.first[4 * t + q], a.first[4 * t + q + 1]);
    y[t] = sum;
  }
}

template <class T>
COMPUEYE_INLINE void adjoint_of(const RunningSums<T>& a, const T* y, T* x, T* scratch) {
  auto* sums = reinterpret_cast<Four<T>*>(scratch);
  for (std::size_t k = 0; k < a.half_rows() * a.half_cols(); ++k) sums[k] = Four<T>{};
  if (a.symmetric) {
    adjoint_symmetric(a, y, sums);
  } else {
    for (std::size_t t = 0; t < a.tables; ++t) {
      for (std::size_t q = 0; q < 4; ++q) {
        for (std::size_t k = a.first[4 * t + q]; k < a.first[4 * t + q + 1]; ++k) {
          scratch[4 * std::size_t{a.element[k]} + q] += a.difference[k] * y[t];
        }
      }
    }
  }
  sum_inward(a, sums, x);
}

template <class T>
std::size_t bytes_of(const RunningSums<T>& a) {
  const std::size_t taps = a.first[4 * a.tables];
  return taps * (sizeof(T) + sizeof(std::uint16_t)) + (4 * a.tables + 1) * sizeof(std::uint32_t) +
         (a.symmetric ? 4 * a.tables * sizeof(std::int32_t) : 0);
}

template <class T>
std::size_t flops_of(const RunningSums<T>& a) {
  const std::size_t taps = a.first[4 * a.tables];
  return taps * (a.symmetric ? 4 : 1) + 4 * a.half_rows() * a.half_cols();
}

}  // namespace

std::size_t bytes(const RunningSums<float>& a) noexcept {
  return bytes_of(a);
}
std::size_t bytes(const RunningSums<double>& a) noexcept {
  return bytes_of(a);
}
std::size_t flops(const RunningSums<float>& a) noexcept {
  return flops_of(a);
}
std::size_t flops(const RunningSums<double>& a) noexcept {
  return flops_of(a);
}

COMPUEYE_MULTIVERSION void forward(const RunningSums<float>& a, const float* x, float* y, float* scratch) noexcept {
  forward_of(a, x, y, scratch);
}
COMPUEYE_MULTIVERSION void forward(const RunningSums<double>& a, const double* x, double* y, double* scratch) noexcept {
  forward_of(a, x, y, scratch);
}
COMPUEYE_MULTIVERSION void adjoint_accumulate(const RunningSums<float>& a, const float* y, float* x,
                                              float* scratch) noexcept {
  adjoint_of(a, y, x, scratch);
}
COMPUEYE_MULTIVERSION void adjoint_accumulate(const RunningSums<double>& a, const double* y, double* x,
                                              double* scratch) noexcept {
  adjoint_of(a, y, x, scratch);
}

}  // namespace compueye::recon::core
