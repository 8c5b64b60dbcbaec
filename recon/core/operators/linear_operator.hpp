#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/operators/dense_runs.hpp"
#include "recon/core/operators/running_sums.hpp"
#include "recon/core/operators/wavelet_runs.hpp"
#include "recon/core/parts/crew.hpp"

namespace compueye::recon {

enum class OperatorKind : std::uint8_t {
  dense,
  csr,
  running_sums,
  running_sums_symmetric,
  running_sums_diagonal,
  dense_runs,
  dense_runs_bf16,
  dense_runs_int8,
  wavelet_runs
};

}  // namespace compueye::recon

namespace compueye::recon::core {

/// A (rows x cols) as the frame path sees it: a view of tables that somebody else owns.
/// dense: values row-major. csr: row m holds entries row_start[m] .. row_start[m+1]-1. Else: core/running_sums.hpp,
/// core/dense_runs.hpp, core/wavelet_runs.hpp.
template <class T>
struct LinearOperator {
  OperatorKind kind = OperatorKind::dense;
  std::size_t rows = 0;
  std::size_t cols = 0;
  const T* values = nullptr;
  const std::uint32_t* row_start = nullptr;
  const std::int32_t* columns = nullptr;
  RunningSums<T> sums = {};
  DenseRuns<T> runs = {};
  WaveletRuns<T> wavelet = {};
  Crew crew = {};  ///< that shares the work, but for the adjoint of csr

  /// Elements of T that forward() and adjoint_accumulate() want as scratch; none but for running sums and
  /// wavelet runs.
  [[nodiscard]] std::size_t scratch_size() const noexcept {
    if (wavelet.picture.rows > 0) return wavelet.scratch_size(crew.workers);
    if (sums.tables == 0) return 0;
    return crew.workers > 1 ? sums.shared_scratch_size() : sums.scratch_size();
  }
};

/// So many more rows than pixels that what is cubic, or square in memory, is made on the side of the pixels.
[[nodiscard]] constexpr bool is_tall(std::size_t rows, std::size_t cols) noexcept {
  return rows / 2 >= cols;
}
template <class T>
[[nodiscard]] constexpr bool is_tall(const LinearOperator<T>& a) noexcept {
  return is_tall(a.rows, a.cols);
}

/// Bytes of tables that one application reads; the same for A and A'.
std::size_t bytes(const LinearOperator<float>& a) noexcept;
std::size_t bytes(const LinearOperator<double>& a) noexcept;

/// Multiply-adds of one application, the additions of running sums among them; the same for A and A'.
std::size_t flops(const LinearOperator<float>& a) noexcept;
std::size_t flops(const LinearOperator<double>& a) noexcept;

/// y = A x
void forward(const LinearOperator<float>& a, const float* x, float* y, float* scratch) noexcept;
void forward(const LinearOperator<double>& a, const double* x, double* y, double* scratch) noexcept;

/// x += A' y. Rows are added in ascending order but by running sums.
void adjoint_accumulate(const LinearOperator<float>& a, const float* y, float* x, float* scratch) noexcept;
void adjoint_accumulate(const LinearOperator<double>& a, const double* y, double* x, double* scratch) noexcept;

}  // namespace compueye::recon::core
