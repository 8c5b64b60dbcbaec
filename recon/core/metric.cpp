#include "recon/core/metric.hpp"

namespace compueye::recon::core {

template <class T>
void apply_inverse(const Metric<T>& metric, T* x, T* coefficients, T* scratch) noexcept {
  if (metric.is_identity()) return;
  dct_forward(metric.dct, x, coefficients, scratch);
  const std::size_t n = metric.dct.rows.length * metric.dct.cols.length;
  for (std::size_t k = 0; k < n; ++k) coefficients[k] *= metric.inverse_eigenvalues[k];
  dct_inverse(metric.dct, coefficients, x, scratch);
}

template void apply_inverse(const Metric<float>&, float*, float*, float*) noexcept;
template void apply_inverse(const Metric<double>&, double*, double*, double*) noexcept;

}  // namespace compueye::recon::core
