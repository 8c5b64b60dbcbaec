#pragma once

#include <vector>

#include "sim/scene/surface.hpp"

namespace compueye::sim {

/// Running integrals along each row of a surface's picture, so that the light on any piece of a scanline costs two
/// look-ups whatever its length.
class PictureIntegral {
 public:
  explicit PictureIntegral(const Surface& surface);

  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] double left_mm() const noexcept { return left_; }
  [[nodiscard]] double right_mm() const noexcept { return -left_; }
  [[nodiscard]] double pixel_width_mm() const noexcept { return pixel_width_; }
  [[nodiscard]] double pixel_height_mm() const noexcept { return pixel_height_; }
  /// y of the upper edge of row `row`; row = rows() gives the lower edge of the picture.
  [[nodiscard]] double top_of_mm(int row) const noexcept { return top_ - row * pixel_height_; }
  [[nodiscard]] bool black(int row) const noexcept {
    return sums_[start(row) + static_cast<std::size_t>(cols_)] == 0.0;
  }

  /// Integral of intensity dx (mm) over left <= x0 <= x1 <= right within one row.
  [[nodiscard]] double between(int row, double x0_mm, double x1_mm) const noexcept {
    const double* sums = sums_.data() + start(row);
    return (up_to(sums, x1_mm) - up_to(sums, x0_mm)) * pixel_width_;
  }

 private:
  [[nodiscard]] std::size_t start(int row) const noexcept {
    return static_cast<std::size_t>(row) * (static_cast<std::size_t>(cols_) + 1);
  }
  [[nodiscard]] double up_to(const double* sums, double x_mm) const noexcept {
    const double pixels = (x_mm - left_) * pixels_per_mm_;
    int col = static_cast<int>(pixels);
    col = col < 0 ? 0 : (col >= cols_ ? cols_ - 1 : col);
    return sums[col] + (pixels - col) * (sums[col + 1] - sums[col]);
  }

  int rows_, cols_;
  double left_, top_, pixel_width_, pixel_height_, pixels_per_mm_;
  std::vector<double> sums_;  // cols + 1 a row, in pixels
};

}  // namespace compueye::sim
