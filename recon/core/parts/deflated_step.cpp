#include "recon/core/parts/deflated_step.hpp"

#include <bit>

#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/square_root.hpp"

namespace compueye::recon::core {
namespace {

constexpr std::size_t group = 16;

template <class T>
COMPUEYE_INLINE T widened(std::uint16_t value) {
  return static_cast<T>(std::bit_cast<float>(static_cast<std::uint32_t>(value) << 16U));
}

template <class T>
using Part = typename DeflatedStep<T>::Part;

/// t = gains .* (U' in) for first columns and for second ones, four rows at a time, each element in the same order
/// whatever the vector width.
template <class T>
COMPUEYE_INLINE void project_of(const Part<T>& part, std::size_t level, const T* __restrict in, T* __restrict t) {
  const std::size_t columns = part.columns();
  const T* __restrict gains = part.gains + level * part.rank;
  const std::uint16_t* __restrict row = part.vectors;
  for (std::size_t k = 0; k < columns; ++k) t[k] = T(0);
  std::size_t p = 0;
  for (; p + 4 <= part.order; p += 4, row += 4 * columns) {
    const std::uint16_t *v1 = row + columns, *v2 = v1 + columns, *v3 = v2 + columns;
    const T a0 = in[p], a1 = in[p + 1], a2 = in[p + 2], a3 = in[p + 3];
    for (std::size_t k = 0; k < columns; ++k) {
      t[k] += (a0 * widened<T>(row[k]) + a1 * widened<T>(v1[k])) + (a2 * widened<T>(v2[k]) + a3 * widened<T>(v3[k]));
    }
  }
  for (; p < part.order; ++p, row += columns) {
    for (std::size_t k = 0; k < columns; ++k) t[k] += in[p] * widened<T>(row[k]);
  }
  for (std::size_t k = 0; k < part.refined; ++k) t[k] += t[part.rank + k];
  for (std::size_t k = 0; k < part.rank; ++k) t[k] *= gains[k];
  for (std::size_t k = 0; k < part.refined; ++k) t[part.rank + k] = t[k];
}

template <class T>
COMPUEYE_INLINE T row_times(const std::uint16_t* __restrict row, const T* __restrict t, std::size_t columns) {
  T sum[group] = {};
  for (std::size_t k = 0; k < columns; k += group) {
    for (std::size_t l = 0; l < group; ++l) sum[l] += t[k + l] * widened<T>(row[k + l]);
  }
  for (std::size_t half = group / 2; half > 0; half /= 2) {
    for (std::size_t l = 0; l < half; ++l) sum[l] += sum[l + half];
  }
  return sum[0];
}

/// in = f_0 in + U t
template <class T>
COMPUEYE_INLINE void expand_of(const Part<T>& part, std::size_t level, const T* __restrict t, T* __restrict in) {
  const std::size_t columns = part.columns();
  for (std::size_t p = 0; p < part.order; ++p) {
    in[p] = part.rest[level] * in[p] + row_times(part.vectors + p * columns, t, columns);
  }
}

COMPUEYE_MULTIVERSION void step_class(const Part<float>& part, std::size_t level, float* in, float* t) noexcept {
  project_of<float>(part, level, in, t);
  expand_of<float>(part, level, t, in);
}
COMPUEYE_MULTIVERSION void step_class(const Part<double>& part, std::size_t level, double* in, double* t) noexcept {
  project_of<double>(part, level, in, t);
  expand_of<double>(part, level, t, in);
}

/// From the rows of a place's four images to its four classes, or back.
template <class T>
COMPUEYE_INLINE void butterfly(T& a, T& b, T& c, T& d) {
  const T even = a + b, odd = a - b, even_below = c + d, odd_below = c - d;
  a = T(0.5) * (even + even_below);
  b = T(0.5) * (odd + odd_below);
  c = T(0.5) * (even - even_below);
  d = T(0.5) * (odd - odd_below);
}

template <class T>
void apply_to_images(const DeflatedStep<T>& f, std::size_t level, const T* x, T* y, T* scratch) noexcept {
  const std::size_t places = f.order / 4;
  T *in = scratch, *t = scratch + f.order;
  for (std::size_t p = 0; p < places; ++p) {
    const std::int32_t* rows = f.images + 4 * p;
    T a = x[rows[0]], b = x[rows[1]], c = x[rows[2]], d = x[rows[3]];
    butterfly(a, b, c, d);
    in[p] = a;
    in[places + p] = b;
    in[2 * places + p] = c;
    in[3 * places + p] = d;
  }
  const std::size_t apart = (f.scratch_size() - f.order) / 4;
  f.crew.share(4, f.order * apart, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) step_class(f.parts[c], level, in + c * places, t + c * apart);
  });
  for (std::size_t p = 0; p < places; ++p) {
    const std::int32_t* rows = f.images + 4 * p;
    T a = in[p], b = in[places + p], c = in[2 * places + p], d = in[3 * places + p];
    butterfly(a, b, c, d);
    y[rows[0]] = a;
    y[rows[1]] = b;
    y[rows[2]] = c;
    y[rows[3]] = d;
  }
}

template <class T>
void apply_of(const DeflatedStep<T>& f, std::size_t level, const T* x, T* y, T* scratch) noexcept {
  if (f.images != nullptr) return apply_to_images(f, level, x, y, scratch);
  T *in = scratch, *t = scratch + f.order;
  if (f.classes == 1) {
    for (std::size_t m = 0; m < f.order; ++m) y[m] = x[m];
    return step_class(f.parts[0], level, y, t);
  }
  for (std::size_t m = 0; m < f.order; ++m) y[m] = T(0);
  for (std::size_t c = 0; c < f.classes; ++c) {
    const auto& part = f.parts[c];
    for (std::size_t p = 0; p < part.order; ++p) in[p] = T(0);
    for (std::size_t m = 0; m < f.order; ++m) {
      if (part.index[m] >= 0) in[part.index[m]] += part.share[m] * x[m];
    }
    step_class(part, level, in, t);
    for (std::size_t m = 0; m < f.order; ++m) {
      if (part.index[m] >= 0) y[m] += part.share[m] * in[part.index[m]];
    }
  }
}

template <class T>
std::ptrdiff_t place_of(const Part<T>& part, std::size_t row) noexcept {
  return part.index == nullptr ? static_cast<std::ptrdiff_t>(row) : part.index[row];
}

/// Entry (i, j) of F's part; `t` are the gains times the modes at i.
template <class T>
COMPUEYE_INLINE double entry_of(const Part<T>& part, std::size_t i, std::size_t j, const T* t) {
  const std::ptrdiff_t p = place_of<T>(part, i), q = place_of<T>(part, j);
  if (q < 0) return 0.0;
  const T over_modes = row_times(part.vectors + static_cast<std::size_t>(q) * part.columns(), t, part.columns());
  const double entry = static_cast<double>(over_modes) + (p == q ? static_cast<double>(part.rest[0]) : 0.0);
  if (part.index == nullptr) return entry;
  return entry * static_cast<double>(part.share[i]) * static_cast<double>(part.share[j]);
}

template <class T>
COMPUEYE_INLINE void restrict_of(const DeflatedStep<T>& f, const std::size_t* index, std::size_t count, double* out,
                                 T* t) {
  for (std::size_t k = 0; k < count * count; ++k) out[k] = 0.0;
  for (std::size_t c = 0; c < f.classes; ++c) {
    const auto& part = f.parts[c];
    for (std::size_t s = 0; s < count; ++s) {
      const std::ptrdiff_t p = place_of<T>(part, index[s]);
      if (p < 0) continue;
      const std::uint16_t* row = part.vectors + static_cast<std::size_t>(p) * part.columns();
      for (std::size_t k = 0; k < part.rank; ++k) t[k] = widened<T>(row[k]);
      for (std::size_t k = 0; k < part.refined; ++k) t[k] += widened<T>(row[part.rank + k]);
      for (std::size_t k = 0; k < part.rank; ++k) t[k] *= part.gains[k];
      for (std::size_t k = 0; k < part.refined; ++k) t[part.rank + k] = t[k];
      for (std::size_t r = 0; r <= s; ++r) out[s * count + r] += entry_of<T>(part, index[s], index[r], t);
    }
  }
}

template <class T>
void read_modes_of(const Part<T>& part, std::size_t row, double* out) noexcept {
  const std::uint16_t* stored = part.vectors + row * part.columns();
  for (std::size_t k = 0; k < part.rank; ++k) {
    T value = widened<T>(stored[k]);
    if (k < part.refined) value += widened<T>(stored[part.rank + k]);
    const double drop = -static_cast<double>(part.gains[k]);
    out[k] = drop > 0.0 ? square_root(drop) * static_cast<double>(value) : 0.0;
  }
}

}  // namespace

void read_modes(const DeflatedStep<float>::Part& part, std::size_t row, double* out) noexcept {
  read_modes_of<float>(part, row, out);
}
void read_modes(const DeflatedStep<double>::Part& part, std::size_t row, double* out) noexcept {
  read_modes_of<double>(part, row, out);
}

void apply(const DeflatedStep<float>& f, std::size_t level, const float* x, float* y, float* scratch) noexcept {
  apply_of(f, level, x, y, scratch);
}
void apply(const DeflatedStep<double>& f, std::size_t level, const double* x, double* y, double* scratch) noexcept {
  apply_of(f, level, x, y, scratch);
}
COMPUEYE_MULTIVERSION void restrict_to(const DeflatedStep<float>& f, const std::size_t* index, std::size_t count,
                                       double* out, float* scratch) noexcept {
  restrict_of(f, index, count, out, scratch);
}
COMPUEYE_MULTIVERSION void restrict_to(const DeflatedStep<double>& f, const std::size_t* index, std::size_t count,
                                       double* out, double* scratch) noexcept {
  restrict_of(f, index, count, out, scratch);
}

}  // namespace compueye::recon::core
