#pragma once

#include <cstddef>
#include <vector>

namespace compueye::hal {

/// A grey picture: linear intensity, row-major, row 0 on top.
struct Image {
  int rows = 0;
  int cols = 0;
  std::vector<float> pixels;

  Image() = default;
  Image(int rows_, int cols_, float value = 0.0F)
      : rows(rows_), cols(cols_), pixels(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_), value) {}

  [[nodiscard]] std::size_t index(int row, int col) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] float& at(int row, int col) noexcept { return pixels[index(row, col)]; }
  [[nodiscard]] float at(int row, int col) const noexcept { return pixels[index(row, col)]; }
};

}  // namespace compueye::hal
