#pragma once

#include <vector>

#include "hal/image.hpp"
#include "sim/render/placed_surface.hpp"

namespace compueye::sim {

/// A rectangle of a surface's picture: x to its right, y up, mm from its centre.
struct Cell {
  double x = 0.0, y = 0.0;  ///< its middle
  double width = 0.0, height = 0.0;
};

[[nodiscard]] inline double half_diagonal(const Cell& cell) noexcept {
  return 0.5 * std::sqrt(cell.width * cell.width + cell.height * cell.height);
}

/// How far a relief stands out at the corners of the pixels of its picture, mm; within a pixel bilinear between its
/// four corners. The height map is taken as bilinear between the middles of its own pixels, level beyond the outermost.
class ReliefHeights {
 public:
  ReliefHeights(const hal::Image& heights, int rows, int cols, double width_mm, double height_mm);

  struct Patch {
    double height, slope_x, slope_y;
  };
  /// The pixel that holds a point; one on an edge belongs to either.
  struct Pixel {
    int row, col;
  };
  [[nodiscard]] Pixel pixel_at(double x, double y) const noexcept;
  [[nodiscard]] Patch patch(const Pixel& pixel, double x, double y) const noexcept;

  [[nodiscard]] bool within_pixel(const Cell& cell) const noexcept {
    return cell.width * cols_ <= width_ * (1.0 + 1e-9) && cell.height * rows_ <= height_ * (1.0 + 1e-9);
  }

  struct Range {
    double lo, hi;
  };
  /// Of the heights in a cell, or a little more.
  [[nodiscard]] Range range(const Cell& cell) const noexcept;
  [[nodiscard]] double highest() const noexcept { return ranges_.back().ranges.front().hi; }

  /// Least clearance of the straight way from a point of a pixel to `apex` (in the relief's frame, z > 0 before it)
  /// over the relief, each divided by its share of the way: negative where the point is hidden.
  [[nodiscard]] double clearance(const Pixel& pixel, double x, double y, const hal::Vec3& apex) const noexcept;
  /// Certain that no point of the cell is hidden.
  [[nodiscard]] bool clear(const Cell& cell, const hal::Vec3& apex) const noexcept;

 private:
  struct Level {
    int size, rows, cols;
    std::vector<Range> ranges;   ///< of blocks of size x size pixels
    std::vector<double> around;  ///< highest of a block and its neighbours
  };
  [[nodiscard]] double at(int row, int col) const noexcept {
    return corners_[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_ + 1) +
                    static_cast<std::size_t>(col)];
  }
  [[nodiscard]] Range range_within(const Cell& cell) const noexcept;  ///< of a part of one pixel
  [[nodiscard]] const Level& level_for(double pixels) const noexcept;
  [[nodiscard]] double height_on_line(double col, double row, bool vertical) const noexcept;
  void add_level(int size);

  int rows_, cols_;
  double width_, height_;        // of the relief, mm
  std::vector<double> corners_;  // (rows + 1) x (cols + 1), row 0 on top
  std::vector<Level> ranges_;    // from the finest, of single pixels
};

}  // namespace compueye::sim
