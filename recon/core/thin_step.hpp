#pragma once

#include <cstddef>
#include <cstdint>

namespace compueye::recon::core {

/// The quadratic step of a small eye whose weights are all one, as two thin products and nothing else:
///
///   x = v + K (y - A v),   K = A' (A A' + rho I)^-1
///
/// Where A is mirror symmetric and no row or pixel lies on an axis, four mirror images share a lane each: a pixel's and
/// a row's four images are turned into their four parity classes (sums and differences), in which A and K fall into
/// four blocks of a quarter the order, one a lane. Pixels are then kept in the order of `pixel` throughout the
/// solution.
template <class T>
struct ThinStep {
  std::size_t rows = 0;                 ///< of A, or sets of four of them; 0: there is no such step
  std::size_t cols = 0;                 ///< of A, a multiple of 64
  std::size_t lanes = 1;                ///< 1 or 4
  const T* analysis = nullptr;          ///< A: rows x cols; or rows x (cols / 4) x 4, one class a lane
  const T* synthesis = nullptr;         ///< K', likewise
  const std::int32_t* pixel = nullptr;  ///< 4 lanes: cols of them, where each value of the folded order belongs
  const std::int32_t* image = nullptr;  ///< 4 lanes: 4 rows of them, the row of A in each lane

  /// Elements of T that the samples in its order, and a step, take: what a row has to say is repeated to 16 lanes.
  [[nodiscard]] std::size_t sample_size() const noexcept { return 16 * rows; }
};

/// `out` = the samples `y` in the order of the step, sample_size() values.
void order_samples(const ThinStep<float>& step, const float* y, float* out) noexcept;
void order_samples(const ThinStep<double>& step, const double* y, double* out) noexcept;

/// v becomes x, both in the step's order; `samples` as order_samples() left them, `residual` takes sample_size()
/// values. All aligned to 64 bytes.
void apply(const ThinStep<float>& step, const float* samples, float* v, float* residual) noexcept;
void apply(const ThinStep<double>& step, const double* samples, double* v, double* residual) noexcept;

/// x = a picture in the step's order, back in its own.
template <class T>
void restore_picture(const ThinStep<T>& step, const T* ordered, T* x) noexcept {
  for (std::size_t k = 0; k < step.cols; ++k)
    x[step.lanes == 1 ? k : static_cast<std::size_t>(step.pixel[k])] = ordered[k];
}

}  // namespace compueye::recon::core
