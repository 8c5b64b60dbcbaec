#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "hal/image.hpp"

namespace compueye::sim {

/// A picture of even pixels on a rectangle of its own plane, centred on the origin: x to its right, y up, mm. Holds
/// what lets light be summed without a look at every pixel: running sums along rows, and tiles of 4x4, 16x16, ...
/// pixels that stand in for their pixels wherever the weight of the light is smooth.
class PictureSums {
 public:
  /// Tiles cost memory and are only for weights that change over the picture, or regions that are not a whole cone.
  PictureSums(const hal::Image& picture, double width_mm, double height_mm, bool tiles);

  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] int cols() const noexcept { return cols_; }
  [[nodiscard]] double left_mm() const noexcept { return left_; }
  [[nodiscard]] double top_mm() const noexcept { return top_; }
  [[nodiscard]] double pixel_width_mm() const noexcept { return pixel_width_; }
  [[nodiscard]] double pixel_height_mm() const noexcept { return pixel_height_; }

  /// cols + 1 running sums of the row's pixels.
  [[nodiscard]] const double* row_sums(int row) const noexcept { return sums_.data() + start(row); }
  [[nodiscard]] double value(int row, int col) const noexcept {
    const double* sums = row_sums(row);
    return sums[col + 1] - sums[col];
  }
  [[nodiscard]] bool black(int row) const noexcept { return row_sums(row)[cols_] == 0.0; }

  /// Tiles of one size. The weight of the light over a tile is replaced by the polynomial through nodes x nodes Gauss
  /// points of the tile, whose integral against the picture is a sum of `masses` (row by row of points, from the lower
  /// left; in pixels) times the weight at the points.
  struct Level {
    int size = 0;  ///< pixels across and down, fewer at the picture's right and lower edges
    int rows = 0, cols = 0, nodes = 0;
    std::vector<double> masses;
    std::vector<double> total;    ///< of the pixels of each tile
    std::vector<double> uneven;   ///< sum of |masses - masses of an even tile of that total|: 0 for an even tile
    std::vector<bool> one_value;  ///< all pixels of the tile are alike
  };
  /// From the finest; the last one is a single tile.
  [[nodiscard]] const std::vector<Level>& levels() const noexcept { return levels_; }

 private:
  [[nodiscard]] std::size_t start(int row) const noexcept {
    return static_cast<std::size_t>(row) * (static_cast<std::size_t>(cols_) + 1);
  }
  void add_level(const hal::Image& picture, int size);

  int rows_, cols_;
  double left_, top_, pixel_width_, pixel_height_;
  std::vector<double> sums_;
  std::vector<Level> levels_;
};

/// Points of Gauss and Legendre's rule and their weights on -1 .. 1, weights of sum 2; 1 <= count <= 5.
struct GaussRule {
  std::array<double, 5> at{}, weight{};
};
[[nodiscard]] const GaussRule& gauss_rule(int count) noexcept;

}  // namespace compueye::sim
