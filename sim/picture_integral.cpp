#include "sim/picture_integral.hpp"

namespace compueye::sim {

PictureIntegral::PictureIntegral(const Scene& scene)
    : rows_(scene.picture.rows),
      cols_(scene.picture.cols),
      left_(-scene.width_mm / 2.0),
      top_(scene.height_mm / 2.0),
      pixel_width_(scene.width_mm / cols_),
      pixel_height_(scene.height_mm / rows_),
      pixels_per_mm_(cols_ / scene.width_mm),
      sums_(start(rows_)) {
  for (int row = 0; row < rows_; ++row) {
    double* sums = sums_.data() + start(row);
    for (int col = 0; col < cols_; ++col) sums[col + 1] = sums[col] + static_cast<double>(scene.picture.at(row, col));
  }
}

}  // namespace compueye::sim
