#include "recon/core/parts/cholesky.hpp"

#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
bool cholesky_factor(double* a, std::size_t order) noexcept {
  for (std::size_t i = 0; i < order; ++i) {
    double* row = a + i * order;
    for (std::size_t j = 0; j < i; ++j) {
      const double* other = a + j * order;
      row[j] = (row[j] - dot(row, other, j)) / other[j];
    }
    const double pivot = row[i] - dot(row, row, i);
    if (!(pivot > 0.0) || pivot > 1e300) return false;
    row[i] = square_root(pivot);
  }
  return true;
}

void cholesky_solve(const double* l, std::size_t order, double* b) noexcept {
  for (std::size_t i = 0; i < order; ++i) b[i] = (b[i] - dot(l + i * order, b, i)) / l[i * order + i];
  for (std::size_t i = order; i-- > 0;) {
    b[i] /= l[i * order + i];
    const double known = b[i];
    for (std::size_t j = 0; j < i; ++j) b[j] -= l[i * order + j] * known;
  }
}

}  // namespace compueye::recon::core
