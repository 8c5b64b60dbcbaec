#include "recon/core/parts/packed_symmetric.hpp"

#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
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
