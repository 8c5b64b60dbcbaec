#include <vector>

#include "calib/patterns/hadamard_matrix.hpp"
#include "calib/patterns/pattern_painters.hpp"

namespace compueye::calib {
namespace {

enum class Layout { by_rows_and_columns, by_pixels, cropped };

Layout layout_of(int rows, int cols) {
  if (HadamardMatrix::exists(rows) && HadamardMatrix::exists(cols)) return Layout::by_rows_and_columns;
  return HadamardMatrix::exists(rows * cols) ? Layout::by_pixels : Layout::cropped;
}

/// Of `count` columns of a matrix of this order, from `first` on.
std::vector<int> signs_of(int order, int row, int first, int count) {
  const auto matrix = HadamardMatrix::of_order(order);
  std::vector<int> signs;
  if (!matrix) return signs;
  signs.reserve(static_cast<std::size_t>(count));
  for (int col = first; col < first + count; ++col) signs.push_back(matrix->at(row, col));
  return signs;
}

std::vector<int> signs_of_pixels(int rows, int cols, int index) {
  const int pixels = rows * cols;
  switch (layout_of(rows, cols)) {
    case Layout::by_rows_and_columns: {
      const auto down = signs_of(rows, index / cols, 0, rows), across = signs_of(cols, index % cols, 0, cols);
      std::vector<int> signs;
      signs.reserve(static_cast<std::size_t>(pixels));
      for (const int d : down) {
        for (const int a : across) signs.push_back(d * a);
      }
      return signs;
    }
    case Layout::by_pixels:
      return signs_of(pixels, index, 0, pixels);
    case Layout::cropped:
      return signs_of(HadamardMatrix::order_at_least(pixels + 1), index + 1, 1, pixels);
  }
  return {};
}

}  // namespace

std::int64_t hadamard_count(int rows, int cols) {
  const int pixels = rows * cols;
  return layout_of(rows, cols) == Layout::cropped ? HadamardMatrix::order_at_least(pixels + 1) - 1 : pixels;
}

hal::Image hadamard_pattern(int rows, int cols, std::uint64_t, std::int64_t index) {
  const bool all_on = index == 0 && layout_of(rows, cols) != Layout::cropped;
  if (all_on) return {rows, cols, 1.0F};
  hal::Image image(rows, cols);
  const std::vector<int> signs = signs_of_pixels(rows, cols, static_cast<int>(index));
  for (std::size_t n = 0; n < signs.size(); ++n) image.pixels[n] = signs[n] < 0 ? 1.0F : 0.0F;
  return image;
}

}  // namespace compueye::calib
