#pragma once

#include <cstddef>
#include <cstdint>

namespace compueye::recon::core {

/// The quadratic step of a small eye whose weights are all one, as two thin products with the same table and nothing
/// else. With A A' = V diag(s) V', B = V' A and the samples turned once a frame,
///
///   x = v + A' (A A' + rho I)^-1 (y - A v) = v + B' diag(1 / (s + rho)) (V' y - B v)
///
/// so that rho may change from one iteration to the next. Where A is mirror symmetric and no row or pixel lies on an
/// axis, four mirror images share a lane each: a pixel's and a row's four images are turned into their four parity
/// classes (sums and differences), in which A and V fall into four blocks of a quarter the order, one a lane. Pixels
/// are then kept in the order of `pixel` throughout the solution.
template <class T>
struct ThinStep {
  std::size_t rows = 0;                 ///< of A, or sets of four of them; 0: there is no such step
  std::size_t cols = 0;                 ///< of A, a multiple of 64
  std::size_t lanes = 1;                ///< 1 or 4
  std::size_t levels = 0;               ///< of rho, as in the problem's PenaltySchedule
  const T* turned = nullptr;            ///< B: rows x cols; or rows x (cols / 4) x 4, one class a lane
  const T* gains = nullptr;             ///< 1 / (s + rho): levels x rows x lanes
  const T* rotation = nullptr;          ///< V: rows x rows x lanes
  const std::int32_t* pixel = nullptr;  ///< 4 lanes: cols of them, where each value of the folded order belongs
  const std::int32_t* image = nullptr;  ///< 4 lanes: 4 rows of them, the row of A in each lane

  /// Elements of T that the samples in its order, and a step, take: what a row has to say is repeated to 16 lanes.
  [[nodiscard]] std::size_t sample_size() const noexcept { return 16 * rows; }
};

/// `out` = V' y in the order of the step, sample_size() values; `scratch` takes as many.
void turn_samples(const ThinStep<float>& step, const float* y, float* out, float* scratch) noexcept;
void turn_samples(const ThinStep<double>& step, const double* y, double* out, double* scratch) noexcept;

/// v becomes x with the rho of `level`, both in the step's order; `samples` as turn_samples() left them, `residual`
/// takes sample_size() values. All aligned to 64 bytes.
void apply(const ThinStep<float>& step, std::size_t level, const float* samples, float* v, float* residual) noexcept;
void apply(const ThinStep<double>& step, std::size_t level, const double* samples, double* v,
           double* residual) noexcept;

/// x = a picture in the step's order, back in its own.
template <class T>
void restore_picture(const ThinStep<T>& step, const T* ordered, T* x) noexcept {
  for (std::size_t k = 0; k < step.cols; ++k)
    x[step.lanes == 1 ? k : static_cast<std::size_t>(step.pixel[k])] = ordered[k];
}

}  // namespace compueye::recon::core
