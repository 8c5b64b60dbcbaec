#include "sim/picture_integral.hpp"

namespace compueye::sim {

PictureIntegral::PictureIntegral(const Surface& surface)
    : rows_(surface.picture().rows),
      cols_(surface.picture().cols),
      left_(-surface.width_mm / 2.0),
      top_(surface.height_mm / 2.0),
      pixel_width_(surface.width_mm / cols_),
      pixel_height_(surface.height_mm / rows_),
      pixels_per_mm_(cols_ / surface.width_mm),
      sums_(start(rows_)) {
  for (int row = 0; row < rows_; ++row) {
    double* sums = sums_.data() + start(row);
    for (int col = 0; col < cols_; ++col)
      sums[col + 1] = sums[col] + static_cast<double>(surface.picture().at(row, col));
  }
}

}  // namespace compueye::sim
