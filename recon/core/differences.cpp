#include "recon/core/differences.hpp"

#include "recon/core/multiversion.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
COMPUEYE_INLINE void forward_of(const T* __restrict x, std::size_t rows, std::size_t cols, T* __restrict d) {
  T *right = d, *down = d + rows * cols;
  for (std::size_t r = 0; r < rows; ++r) {
    const T* row = x + r * cols;
    for (std::size_t c = 0; c + 1 < cols; ++c) right[r * cols + c] = row[c + 1] - row[c];
    right[r * cols + cols - 1] = T(0);
    if (r + 1 < rows) {
      for (std::size_t c = 0; c < cols; ++c) down[r * cols + c] = row[cols + c] - row[c];
    } else {
      for (std::size_t c = 0; c < cols; ++c) down[r * cols + c] = T(0);
    }
  }
}

template <class T>
COMPUEYE_INLINE void adjoint_of(const T* __restrict d, std::size_t rows, std::size_t cols, T* __restrict x) {
  const T *right = d, *down = d + rows * cols;
  for (std::size_t r = 0; r < rows; ++r) {
    T* row = x + r * cols;
    const T* steps = right + r * cols;
    row[0] = cols > 1 ? -steps[0] : T(0);
    for (std::size_t c = 1; c + 1 < cols; ++c) row[c] = steps[c - 1] - steps[c];
    if (cols > 1) row[cols - 1] = steps[cols - 2];
    if (r > 0) {
      for (std::size_t c = 0; c < cols; ++c) row[c] += down[(r - 1) * cols + c];
    }
    if (r + 1 < rows) {
      for (std::size_t c = 0; c < cols; ++c) row[c] -= down[r * cols + c];
    }
  }
}

}  // namespace

COMPUEYE_MULTIVERSION void differences(const float* x, std::size_t rows, std::size_t cols, float* d) noexcept {
  forward_of(x, rows, cols, d);
}
COMPUEYE_MULTIVERSION void differences(const double* x, std::size_t rows, std::size_t cols, double* d) noexcept {
  forward_of(x, rows, cols, d);
}
COMPUEYE_MULTIVERSION void differences_adjoint(const float* d, std::size_t rows, std::size_t cols, float* x) noexcept {
  adjoint_of(d, rows, cols, x);
}
COMPUEYE_MULTIVERSION void differences_adjoint(const double* d, std::size_t rows, std::size_t cols,
                                               double* x) noexcept {
  adjoint_of(d, rows, cols, x);
}

}  // namespace compueye::recon::core
