#include "recon/core/frame/metric.hpp"

namespace compueye::recon::core {

template <class T>
void apply_inverse(const Metric<T>& metric, T* x, T* coefficients, T* scratch) noexcept {
  if (metric.is_identity()) return;
  dct_forward(metric.dct, x, coefficients, scratch);
  const std::size_t n = metric.dct.rows.length * metric.dct.cols.length;
  metric.dct.crew.share(n, n, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) coefficients[k] *= metric.inverse_eigenvalues[k];
  });
  dct_inverse(metric.dct, coefficients, x, scratch);
}

template void apply_inverse(const Metric<float>&, float*, float*, float*) noexcept;
template void apply_inverse(const Metric<double>&, double*, double*, double*) noexcept;

}  // namespace compueye::recon::core
