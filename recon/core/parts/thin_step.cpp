#include "recon/core/parts/thin_step.hpp"

#include "recon/core/parts/multiversion.hpp"
#if defined(COMPUEYE_CORTEX_M)
#include "recon/core/parts/thin_step_by_number.hpp"
#endif

namespace compueye::recon::core {
namespace {

constexpr std::size_t group = 16;

#if !defined(COMPUEYE_CORTEX_M)
template <class T>
struct SixteenLanes;
template <>
struct SixteenLanes<float> {
  using type = float __attribute__((vector_size(64)));
};
template <>
struct SixteenLanes<double> {
  using type __attribute__((aligned(64))) = double __attribute__((vector_size(128)));
};
template <class T>
using Sixteen = typename SixteenLanes<T>::type;

constexpr std::size_t block = 4 * group;

template <class T>
COMPUEYE_INLINE void load(const T* from, Sixteen<T>& to) {
  to = *reinterpret_cast<const Sixteen<T>*>(from);
}

/// Every four lanes a, b, c, d become half of a+b+c+d, a-b+c-d, a+b-c-d and a-b-c+d.
template <class T>
COMPUEYE_INLINE void turn_classes(Sixteen<T>& v) {
  constexpr Sixteen<T> across = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1};
  constexpr Sixteen<T> down = {1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1};
  const Sixteen<T> sideways = __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14);
  v = v * across + sideways;
  const Sixteen<T> upward = __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13);
  v = T(0.5) * (v * down + upward);
}

template <class T>
COMPUEYE_INLINE void turn_picture(T* v, std::size_t cols) {
  for (std::size_t k = 0; k < cols; k += group) turn_classes<T>(*reinterpret_cast<Sixteen<T>*>(v + k));
}

/// The sum of 16 lanes in every lane; or, of every fourth lane, in all of those. Added in the tree 8, 4 (, 2, 1), whose
/// two halves are the same numbers.
template <class T, std::size_t lanes>
COMPUEYE_INLINE void add_lanes(Sixteen<T>& v) {
  v += __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7);
  v += __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11);
  if constexpr (lanes == 4) return;
  v += __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13);
  v += __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14);
}

/// The `lanes` values at `from`, again and again.
template <class T, std::size_t lanes>
COMPUEYE_INLINE void spread(const T* from, Sixteen<T>& to) {
  if constexpr (lanes == 1) {
    to = Sixteen<T>{} + from[0];
  } else {
    const T a = from[0], b = from[1], c = from[2], d = from[3];
    to = Sixteen<T>{a, b, c, d, a, b, c, d, a, b, c, d, a, b, c, d};
  }
}

/// residual = gains .* (samples - B v), four rows in one pass over v.
template <class T, std::size_t lanes>
COMPUEYE_INLINE void subtract_forward(const ThinStep<T>& step, const T* gains, const T* samples, const T* v,
                                      T* residual) {
  for (std::size_t i = 0; i < step.rows; i += 4) {
    const std::size_t count = step.rows - i < 4 ? step.rows - i : 4;
    const T* rows[4];
    for (std::size_t r = 0; r < 4; ++r) rows[r] = step.turned + (i + (r < count ? r : 0)) * step.cols;
    Sixteen<T> sum[4] = {};
    for (std::size_t k = 0; k < step.cols; k += group) {
      Sixteen<T> pixels;
      load(v + k, pixels);
      for (std::size_t r = 0; r < 4; ++r) {
        Sixteen<T> entries;
        load(rows[r] + k, entries);
        sum[r] += entries * pixels;
      }
    }
    for (std::size_t r = 0; r < count; ++r) {
      Sixteen<T> measured, gain;
      load(samples + (i + r) * group, measured);
      spread<T, lanes>(gains + (i + r) * lanes, gain);
      add_lanes<T, lanes>(sum[r]);
      *reinterpret_cast<Sixteen<T>*>(residual + (i + r) * group) = gain * (measured - sum[r]);
    }
  }
}

/// v += B' residual, 64 pixels in one pass over the rows.
template <class T>
COMPUEYE_INLINE void add_adjoint(const ThinStep<T>& step, const T* residual, T* v) {
  for (std::size_t first = 0; first < step.cols; first += block) {
    Sixteen<T> sum[4];
    for (std::size_t b = 0; b < 4; ++b) load(v + first + b * group, sum[b]);
    for (std::size_t i = 0; i < step.rows; ++i) {
      Sixteen<T> scale;
      load(residual + i * group, scale);
      const T* row = step.turned + i * step.cols + first;
      for (std::size_t b = 0; b < 4; ++b) {
        Sixteen<T> entries;
        load(row + b * group, entries);
        sum[b] += entries * scale;
      }
    }
    for (std::size_t b = 0; b < 4; ++b) *reinterpret_cast<Sixteen<T>*>(v + first + b * group) = sum[b];
  }
}
#endif

template <class T>
COMPUEYE_INLINE void apply_of(const ThinStep<T>& step, std::size_t level, const T* samples, T* v, T* residual) {
  const T* gains = step.gains + level * step.rows * step.lanes;
  if (step.lanes == 1) {
    subtract_forward<T, 1>(step, gains, samples, v, residual);
    return add_adjoint(step, residual, v);
  }
  turn_picture(v, step.cols);
  subtract_forward<T, 4>(step, gains, samples, v, residual);
  add_adjoint(step, residual, v);
  turn_picture(v, step.cols);
}

/// The samples of each lane's class, step.lanes a row.
template <class T>
COMPUEYE_STAGE void sort_into_classes(const ThinStep<T>& step, const T* y, T* out) noexcept {
  for (std::size_t i = 0; i < step.rows; ++i) {
    if (step.lanes == 1) {
      out[i] = y[i];
      continue;
    }
    const std::int32_t* rows = step.image + 4 * i;
    const T a = y[rows[0]], b = y[rows[1]], c = y[rows[2]], d = y[rows[3]];
    out[4 * i] = T(0.5) * ((a + b) + (c + d));
    out[4 * i + 1] = T(0.5) * ((a - b) + (c - d));
    out[4 * i + 2] = T(0.5) * ((a + b) - (c + d));
    out[4 * i + 3] = T(0.5) * ((a - b) - (c - d));
  }
}

template <class T, std::size_t lanes>
COMPUEYE_STAGE void rotate(const ThinStep<T>& step, const T* __restrict in, T* __restrict sum, T* __restrict out) {
  const std::size_t width = step.rows * lanes;
  for (std::size_t k = 0; k < width; ++k) sum[k] = T(0);
  for (std::size_t j = 0; j < step.rows; ++j) {
    const T* __restrict row = step.rotation + j * width;
    for (std::size_t k = 0; k < width; k += lanes) {
      for (std::size_t l = 0; l < lanes; ++l) sum[k + l] += row[k + l] * in[j * lanes + l];
    }
  }
  for (std::size_t i = 0; i < step.rows; ++i) {
    for (std::size_t l = 0; l < group; ++l) out[i * group + l] = sum[i * lanes + l % lanes];
  }
}

template <class T>
COMPUEYE_STAGE void turn_of(const ThinStep<T>& step, const T* y, T* out, T* scratch) {
  sort_into_classes(step, y, scratch);
  T* sum = scratch + step.rows * step.lanes;
  if (step.lanes == 1) return rotate<T, 1>(step, scratch, sum, out);
  rotate<T, 4>(step, scratch, sum, out);
}

}  // namespace

COMPUEYE_MULTIVERSION void apply(const ThinStep<float>& step, std::size_t level, const float* samples, float* v,
                                 float* residual) noexcept {
  apply_of(step, level, samples, v, residual);
}
COMPUEYE_MULTIVERSION void apply(const ThinStep<double>& step, std::size_t level, const double* samples, double* v,
                                 double* residual) noexcept {
  apply_of(step, level, samples, v, residual);
}
COMPUEYE_MULTIVERSION void turn_samples(const ThinStep<float>& step, const float* y, float* out,
                                        float* scratch) noexcept {
  turn_of(step, y, out, scratch);
}
COMPUEYE_MULTIVERSION void turn_samples(const ThinStep<double>& step, const double* y, double* out,
                                        double* scratch) noexcept {
  turn_of(step, y, out, scratch);
}

}  // namespace compueye::recon::core
