#include "recon/core/bases/fourier.hpp"

#include "recon/core/bases/strip.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
void transform_2d(bool inverse, const Fourier2d<T>& psi, const T* in, T* out, T* scratch) {
  const auto multiply = [inverse](const T* table, std::size_t n, const T* strip, T* result) {
    if (inverse) {
      strip_product_transposed(table, n, strip, result);
    } else {
      strip_product(table, n, strip, result, std::size_t{1});
    }
  };
  along_columns(psi.rows, psi.cols, psi.cols, in, out, scratch,
                [&](T* strip, T* result, T*) { multiply(psi.row_table, psi.rows, strip, result); });
  along_rows(psi.rows, psi.cols, psi.cols, out, out, scratch,
             [&](T* strip, T* result, T*) { multiply(psi.col_table, psi.cols, strip, result); });
}

}  // namespace

void fourier_forward(const Fourier2d<float>& psi, const float* in, float* out, float* scratch) noexcept {
  transform_2d(false, psi, in, out, scratch);
}
void fourier_forward(const Fourier2d<double>& psi, const double* in, double* out, double* scratch) noexcept {
  transform_2d(false, psi, in, out, scratch);
}
void fourier_inverse(const Fourier2d<float>& psi, const float* in, float* out, float* scratch) noexcept {
  transform_2d(true, psi, in, out, scratch);
}
void fourier_inverse(const Fourier2d<double>& psi, const double* in, double* out, double* scratch) noexcept {
  transform_2d(true, psi, in, out, scratch);
}

}  // namespace compueye::recon::core
