#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/row_draws.hpp"

namespace compueye::calib {

/// Pixels first .. last of each axis, both included.
struct PixelBox {
  int first_row = 0, last_row = 0, first_col = 0, last_col = 0;
};

/// A random function over the pixels of a box that changes slowly from one to the next: octaves of interpolated
/// lattices of normal numbers (Perlin 1985, "An image synthesizer"), all of the same variance, the finest
/// `finest_pitch_px` (>= 1) between knots, the coarsest at most half the box. Mean 0 and standard deviation 1 at every
/// pixel, over the seeds.
class SmoothField {
 public:
  SmoothField(const PixelBox& box, double finest_pitch_px, RowDraws& draws);

  /// At the centre of a pixel of the box.
  [[nodiscard]] double at(int row, int col) const noexcept;

 private:
  struct Octave {
    double pitch_px, row_offset, col_offset;
    std::size_t first_knot, knots_a_row;
  };

  PixelBox box_;
  std::vector<Octave> octaves_;
  std::vector<double> knots_;
  double scale_ = 1.0;
};

}  // namespace compueye::calib
