#include "recon/core/operators/linear_operator.hpp"

#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
COMPUEYE_INLINE T sparse_dot(const T* values, const std::int32_t* columns, const T* x, std::size_t n) {
  T sum[lanes] = {};
  std::size_t k = 0;
  for (; k + lanes <= n; k += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) sum[l] += values[k + l] * x[columns[k + l]];
  }
  for (std::size_t l = 0; k + l < n; ++l) sum[l] += values[k + l] * x[columns[k + l]];
  for (std::size_t half = lanes / 2; half > 0; half /= 2) {
    for (std::size_t l = 0; l < half; ++l) sum[l] += sum[l + half];
  }
  return sum[0];
}

template <class T>
COMPUEYE_INLINE void csr_forward(const LinearOperator<T>& a, const T* x, T* y, std::size_t begin_row,
                                 std::size_t end_row) {
  for (std::size_t m = begin_row; m < end_row; ++m) {
    const std::size_t begin = a.row_start[m];
    y[m] = sparse_dot(a.values + begin, a.columns + begin, x, a.row_start[m + 1] - begin);
  }
}

template <class T>
COMPUEYE_INLINE void csr_adjoint(const LinearOperator<T>& a, const T* y, T* x) {
  for (std::size_t m = 0; m < a.rows; ++m) {
    const T scale = y[m];
    for (std::size_t e = a.row_start[m]; e < a.row_start[m + 1]; ++e) x[a.columns[e]] += a.values[e] * scale;
  }
}

/// Four rows in one pass over x; every element still adds its rows in ascending order.
template <class T>
COMPUEYE_INLINE void accumulate_four(const T* __restrict a, std::size_t stride, const T* y, T* __restrict x,
                                     std::size_t n) {
  const T *a0 = a, *a1 = a + stride, *a2 = a + 2 * stride, *a3 = a + 3 * stride;
  const T y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3];
  for (std::size_t k = 0; k < n; ++k) {
    T sum = x[k];
    sum += a0[k] * y0;
    sum += a1[k] * y1;
    sum += a2[k] * y2;
    sum += a3[k] * y3;
    x[k] = sum;
  }
}

COMPUEYE_MULTIVERSION void csr_forward_clone(const LinearOperator<float>& a, const float* x, float* y,
                                             std::size_t begin, std::size_t end) noexcept {
  csr_forward(a, x, y, begin, end);
}
COMPUEYE_MULTIVERSION void csr_forward_clone(const LinearOperator<double>& a, const double* x, double* y,
                                             std::size_t begin, std::size_t end) noexcept {
  csr_forward(a, x, y, begin, end);
}
COMPUEYE_MULTIVERSION void four_rows(const float* a, std::size_t stride, const float* y, float* x,
                                     std::size_t n) noexcept {
  accumulate_four(a, stride, y, x, n);
}
COMPUEYE_MULTIVERSION void four_rows(const double* a, std::size_t stride, const double* y, double* x,
                                     std::size_t n) noexcept {
  accumulate_four(a, stride, y, x, n);
}

template <class T>
void forward_of(const LinearOperator<T>& a, const T* x, T* y, T* scratch) noexcept {
  switch (a.kind) {
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal:
      return forward(a.sums, x, y, scratch, a.crew);
    case OperatorKind::csr:
      return a.crew.share(a.rows, a.row_start[a.rows], [&](std::size_t, std::size_t begin, std::size_t end) {
        csr_forward_clone(a, x, y, begin, end);
      });
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      return forward(a.runs, x, y, a.crew);
    case OperatorKind::wavelet_runs:
      return forward(a.wavelet, x, y, scratch, a.crew);
    case OperatorKind::dense:
      break;
  }
  a.crew.share(a.rows, a.rows * a.cols, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) y[m] = dot(a.values + m * a.cols, x, a.cols);
  });
}

template <class T>
void adjoint_of(const LinearOperator<T>& a, const T* y, T* x, T* scratch) noexcept {
  switch (a.kind) {
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal:
      return adjoint_accumulate(a.sums, y, x, scratch, a.crew);
    case OperatorKind::csr:
      return csr_adjoint(a, y, x);
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      return adjoint_accumulate(a.runs, y, x, a.crew);
    case OperatorKind::wavelet_runs:
      return adjoint_accumulate(a.wavelet, y, x, scratch, a.crew);
    case OperatorKind::dense:
      break;
  }
  a.crew.share(a.cols, a.rows * a.cols, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::size_t m = 0;
    for (; m + 4 <= a.rows; m += 4) {
      four_rows(a.values + m * a.cols + begin, a.cols, y + m, x + begin, end - begin);
    }
    for (; m < a.rows; ++m) accumulate(a.values + m * a.cols + begin, y[m], x + begin, end - begin);
  });
}

template <class T>
std::size_t bytes_of(const LinearOperator<T>& a) noexcept {
  switch (a.kind) {
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal:
      return bytes(a.sums);
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      return bytes(a.runs);
    case OperatorKind::wavelet_runs:
      return bytes(a.wavelet);
    case OperatorKind::csr:
      return a.row_start[a.rows] * (sizeof(T) + sizeof(std::int32_t)) + (a.rows + 1) * sizeof(std::uint32_t);
    case OperatorKind::dense:
      break;
  }
  return a.rows * a.cols * sizeof(T);
}

template <class T>
std::size_t flops_of(const LinearOperator<T>& a) noexcept {
  switch (a.kind) {
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal:
      return flops(a.sums);
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      return flops(a.runs);
    case OperatorKind::wavelet_runs:
      return flops(a.wavelet);
    case OperatorKind::csr:
      return a.row_start[a.rows];
    case OperatorKind::dense:
      break;
  }
  return a.rows * a.cols;
}

}  // namespace

std::size_t bytes(const LinearOperator<float>& a) noexcept {
  return bytes_of(a);
}
std::size_t bytes(const LinearOperator<double>& a) noexcept {
  return bytes_of(a);
}
std::size_t flops(const LinearOperator<float>& a) noexcept {
  return flops_of(a);
}
std::size_t flops(const LinearOperator<double>& a) noexcept {
  return flops_of(a);
}

void forward(const LinearOperator<float>& a, const float* x, float* y, float* scratch) noexcept {
  forward_of(a, x, y, scratch);
}
void forward(const LinearOperator<double>& a, const double* x, double* y, double* scratch) noexcept {
  forward_of(a, x, y, scratch);
}
void adjoint_accumulate(const LinearOperator<float>& a, const float* y, float* x, float* scratch) noexcept {
  adjoint_of(a, y, x, scratch);
}
void adjoint_accumulate(const LinearOperator<double>& a, const double* y, double* x, double* scratch) noexcept {
  adjoint_of(a, y, x, scratch);
}

}  // namespace compueye::recon::core
