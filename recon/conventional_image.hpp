#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// The picture a conventional compound eye shows, to be put beside a reconstruction: an eye whose acceptance angle is
/// its interommatidial angle has hardly any overlap, so its samples are shown as they are. Each pixel takes
/// y_m / sum_j a_mj of the seeing ommatidium m whose coverage centroid (the mean position of its pixels weighted by
/// |a_mj|) is nearest to the pixel's centre, clipped to 0..1; of equally near ones, the first.
class ConventionalImage {
 public:
  /// `response` is the narrow eye's, which knows its picture. An ommatidium with a row sum of 0 or less
  /// is taken as blind. Errors: mismatch (N), out_of_range (no ommatidium sees anything).
  [[nodiscard]] static hal::Result<ConventionalImage> create(const Response& response);

  [[nodiscard]] int channels() const noexcept { return channels_; }
  [[nodiscard]] int image_rows() const noexcept { return image_rows_; }
  [[nodiscard]] int image_cols() const noexcept { return image_cols_; }

  /// Row of A that each pixel shows; N entries.
  [[nodiscard]] std::span<const std::int32_t> source_rows() const noexcept { return source_; }

  /// `y` has M entries, `picture` N: both are preconditions. A sample that is NaN shows as 0.
  void render(std::span<const float> y, std::span<float> picture) const noexcept;

 private:
  ConventionalImage() = default;
  int channels_ = 0;
  int image_rows_ = 0;
  int image_cols_ = 0;
  std::vector<std::int32_t> source_;  // pixel -> row of A
  std::vector<float> scale_;          // row of A -> 1 / row sum, 0 when blind
};

}  // namespace compueye::recon
