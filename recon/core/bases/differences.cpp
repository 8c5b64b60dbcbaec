#include "recon/core/bases/differences.hpp"

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
COMPUEYE_INLINE void forward_of(const T* __restrict x, std::size_t rows, std::size_t cols, T* __restrict d,
                                std::size_t begin, std::size_t end) {
  T *right = d, *down = d + rows * cols;
  for (std::size_t r = begin; r < end; ++r) {
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
COMPUEYE_INLINE void adjoint_of(const T* __restrict d, std::size_t rows, std::size_t cols, T* __restrict x,
                                std::size_t begin, std::size_t end) {
  const T *right = d, *down = d + rows * cols;
  for (std::size_t r = begin; r < end; ++r) {
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

COMPUEYE_MULTIVERSION void difference_rows(const float* x, std::size_t rows, std::size_t cols, float* d,
                                           std::size_t begin, std::size_t end) noexcept {
  forward_of(x, rows, cols, d, begin, end);
}
COMPUEYE_MULTIVERSION void adjoint_rows(const float* d, std::size_t rows, std::size_t cols, float* x, std::size_t begin,
                                        std::size_t end) noexcept {
  adjoint_of(d, rows, cols, x, begin, end);
}
COMPUEYE_MULTIVERSION void difference_rows(const double* x, std::size_t rows, std::size_t cols, double* d,
                                           std::size_t begin, std::size_t end) noexcept {
  forward_of(x, rows, cols, d, begin, end);
}
COMPUEYE_MULTIVERSION void adjoint_rows(const double* d, std::size_t rows, std::size_t cols, double* x,
                                        std::size_t begin, std::size_t end) noexcept {
  adjoint_of(d, rows, cols, x, begin, end);
}

template <class T>
void share_differences(const T* x, std::size_t rows, std::size_t cols, T* d, const Crew& crew) noexcept {
  crew.share_from_middle(rows, rows * cols, [&](std::size_t, std::size_t begin, std::size_t end) {
    difference_rows(x, rows, cols, d, begin, end);
  });
}

template <class T>
void share_adjoint(const T* d, std::size_t rows, std::size_t cols, T* x, const Crew& crew) noexcept {
  crew.share_from_middle(rows, rows * cols, [&](std::size_t, std::size_t begin, std::size_t end) {
    adjoint_rows(d, rows, cols, x, begin, end);
  });
}

}  // namespace

void differences(const float* x, std::size_t rows, std::size_t cols, float* d, const Crew& crew) noexcept {
  share_differences(x, rows, cols, d, crew);
}
void differences_adjoint(const float* d, std::size_t rows, std::size_t cols, float* x, const Crew& crew) noexcept {
  share_adjoint(d, rows, cols, x, crew);
}
void differences(const double* x, std::size_t rows, std::size_t cols, double* d, const Crew& crew) noexcept {
  share_differences(x, rows, cols, d, crew);
}
void differences_adjoint(const double* d, std::size_t rows, std::size_t cols, double* x, const Crew& crew) noexcept {
  share_adjoint(d, rows, cols, x, crew);
}

}  // namespace compueye::recon::core
