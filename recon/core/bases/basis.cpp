#include "recon/core/bases/basis.hpp"

#include "recon/core/bases/differences.hpp"
#include "recon/core/bases/wavelet.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
void copy(const T* from, T* to, std::size_t n) noexcept {
  for (std::size_t k = 0; k < n; ++k) to[k] = from[k];
}

template <class T>
void analyse_of(const Basis<T>& psi, const T* x, T* c, T* scratch) noexcept {
  switch (psi.kind) {
    case BasisKind::identity:
      return copy(x, c, psi.pixels());
    case BasisKind::dct:
      return dct_forward(psi.dct, x, c, scratch);
    case BasisKind::haar:
      return wavelet_forward({Wavelet::haar, psi.rows, psi.cols}, x, c, scratch);
    case BasisKind::db4:
      return wavelet_forward({Wavelet::db4, psi.rows, psi.cols}, x, c, scratch);
    case BasisKind::dft:
      return fourier_forward(psi.fourier, x, c, scratch);
    case BasisKind::tv:
      return differences(x, psi.rows, psi.cols, c, psi.dct.crew);
  }
}

template <class T>
void synthesise_of(const Basis<T>& psi, const T* c, T* x, T* scratch) noexcept {
  switch (psi.kind) {
    case BasisKind::identity:
      return copy(c, x, psi.pixels());
    case BasisKind::dct:
      return dct_inverse(psi.dct, c, x, scratch);
    case BasisKind::haar:
      return wavelet_inverse({Wavelet::haar, psi.rows, psi.cols}, c, x, scratch);
    case BasisKind::db4:
      return wavelet_inverse({Wavelet::db4, psi.rows, psi.cols}, c, x, scratch);
    case BasisKind::dft:
      return fourier_inverse(psi.fourier, c, x, scratch);
    case BasisKind::tv:
      return differences_adjoint(c, psi.rows, psi.cols, x, psi.dct.crew);
  }
}

}  // namespace

template <class T>
std::size_t Basis<T>::scratch_size() const noexcept {
  // The separable transforms all work on strips of the longer side.
  return kind == BasisKind::identity ? 0 : dct_scratch_size(rows, cols) * dct.crew.workers;
}

template struct Basis<float>;
template struct Basis<double>;

void analyse(const Basis<float>& psi, const float* x, float* c, float* scratch) noexcept {
  analyse_of(psi, x, c, scratch);
}
void analyse(const Basis<double>& psi, const double* x, double* c, double* scratch) noexcept {
  analyse_of(psi, x, c, scratch);
}
void synthesise(const Basis<float>& psi, const float* c, float* x, float* scratch) noexcept {
  synthesise_of(psi, c, x, scratch);
}
void synthesise(const Basis<double>& psi, const double* c, double* x, double* scratch) noexcept {
  synthesise_of(psi, c, x, scratch);
}

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
