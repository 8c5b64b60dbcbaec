// A light that goes over the picture.

#include <algorithm>

#include "calib/patterns/pattern_painters.hpp"

namespace compueye::calib {
namespace {

struct Spot {
  int across = 1, step = 1;  // pixels
};

Spot spot_of(int rows, int cols) noexcept {
  const int across = std::max(1, std::min(rows, cols) / 8);
  return {across, std::max(1, across / 2)};
}

int steps(int pixels, int step) noexcept {
  return (pixels + step - 1) / step;
}

}  // namespace

std::int64_t raster_count(int rows, int cols) {
  return std::int64_t{rows} * cols;
}

hal::Image raster_pattern(int rows, int cols, std::uint64_t, std::int64_t index) {
  hal::Image image(rows, cols);
  image.pixels[static_cast<std::size_t>(index)] = 1.0F;
  return image;
}

std::int64_t spot_count(int rows, int cols) {
  const int step = spot_of(rows, cols).step;
  return std::int64_t{steps(rows, step)} * steps(cols, step);
}

hal::Image spot_pattern(int rows, int cols, std::uint64_t, std::int64_t index) {
  const Spot spot = spot_of(rows, cols);
  const int a_row = steps(cols, spot.step);
  // In halves of a pixel, so that its centre may lie on an edge.
  const std::int64_t down = (2 * (index / a_row) + 1) * spot.step, across = (2 * (index % a_row) + 1) * spot.step;
  hal::Image image(rows, cols);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const std::int64_t dr = 2 * r + 1 - down, dc = 2 * c + 1 - across;
      if (dr * dr + dc * dc <= std::int64_t{spot.across} * spot.across) image.at(r, c) = 1.0F;
    }
  }
  return image;
}

}  // namespace compueye::calib
