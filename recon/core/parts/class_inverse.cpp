#include "recon/core/parts/class_inverse.hpp"

#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
void add_back(const ClassInverse<T>& h, const typename ClassInverse<T>::Part& part, const T* out, T factor,
              T* y) noexcept {
  for (std::size_t m = 0; m < h.order; ++m) {
    if (part.index[m] >= 0) y[m] += factor * part.share[m] * out[part.index[m]];
  }
}

/// What class c makes of x; `in` and `out` are as long as its matrix.
template <class T>
void multiply_class(const ClassInverse<T>& h, const typename ClassInverse<T>::Part& part, const T* x, T* in,
                    T* out) noexcept {
  for (std::size_t p = 0; p < part.matrix.order; ++p) in[p] = T(0);
  for (std::size_t m = 0; m < h.order; ++m) {
    if (part.index[m] >= 0) in[part.index[m]] += part.share[m] * x[m];
  }
  multiply(part.matrix, in, out);
}

template <class T>
void multiply_of(const ClassInverse<T>& h, const T* x, T* y, T* scratch) noexcept {
  if (h.is_whole()) return multiply(h.parts[0].matrix, x, y);
  // Orders of the classes add up to the whole one's.
  std::size_t first[5] = {};
  for (std::size_t c = 0; c < h.classes; ++c) first[c + 1] = first[c] + h.parts[c].matrix.order;
  T *in = scratch, *out = scratch + h.order;
  h.crew.share(h.classes, h.order * h.order, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) multiply_class(h, h.parts[c], x, in + first[c], out + first[c]);
  });
  for (std::size_t m = 0; m < h.order; ++m) y[m] = T(0);
  for (std::size_t c = 0; c < h.classes; ++c) add_back(h, h.parts[c], out + first[c], T(1), y);
}

template <class T>
void expand_row_of(const ClassInverse<T>& h, std::size_t i, T* row, T* scratch) noexcept {
  if (h.is_whole()) return expand_row(h.parts[0].matrix, i, row);
  for (std::size_t m = 0; m < h.order; ++m) row[m] = T(0);
  for (std::size_t c = 0; c < h.classes; ++c) {
    const auto& part = h.parts[c];
    if (part.index[i] < 0) continue;
    expand_row(part.matrix, static_cast<std::size_t>(part.index[i]), scratch);
    add_back(h, part, scratch, part.share[i], row);
  }
}

}  // namespace

void multiply(const ClassInverse<float>& h, const float* x, float* y, float* scratch) noexcept {
  multiply_of(h, x, y, scratch);
}
void multiply(const ClassInverse<double>& h, const double* x, double* y, double* scratch) noexcept {
  multiply_of(h, x, y, scratch);
}
void expand_row(const ClassInverse<float>& h, std::size_t i, float* row, float* scratch) noexcept {
  expand_row_of(h, i, row, scratch);
}
void expand_row(const ClassInverse<double>& h, std::size_t i, double* row, double* scratch) noexcept {
  expand_row_of(h, i, row, scratch);
}

namespace {

template <class T>
void multiply_of(const PackedSymmetric<T>& h, const T* x, T* y) noexcept {
  for (std::size_t i = 0; i < h.order; ++i) y[i] = T(0);
  const T* row = h.values;
  for (std::size_t i = 0; i < h.order; ++i) {
    const std::size_t beyond = h.order - i - 1;
    y[i] += row[0] * x[i] + dot_and_accumulate(row + 1, x + i + 1, x[i], y + i + 1, beyond);
    row += beyond + 1;
  }
}

template <class T>
void expand_row_of(const PackedSymmetric<T>& h, std::size_t i, T* row) noexcept {
  for (std::size_t j = 0; j < h.order; ++j) row[j] = h.at(i, j);
}

}  // namespace

void multiply(const PackedSymmetric<float>& h, const float* x, float* y) noexcept {
  multiply_of(h, x, y);
}
void multiply(const PackedSymmetric<double>& h, const double* x, double* y) noexcept {
  multiply_of(h, x, y);
}
void expand_row(const PackedSymmetric<float>& h, std::size_t i, float* row) noexcept {
  expand_row_of(h, i, row);
}
void expand_row(const PackedSymmetric<double>& h, std::size_t i, double* row) noexcept {
  expand_row_of(h, i, row);
}

}  // namespace compueye::recon::core
