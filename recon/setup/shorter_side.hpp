#pragma once

#include <cstddef>

#include "recon/problem/response.hpp"

namespace compueye::recon {

/// So many more rows than pixels that what is cubic, or square in memory, is made on the side of the pixels.
[[nodiscard]] constexpr bool is_tall(int rows, int cols) noexcept {
  return rows / 2 >= cols;
}
[[nodiscard]] inline bool is_tall(const Response& seeing) noexcept {
  return is_tall(seeing.rows(), seeing.cols());
}

/// How many modes A A' has: of a tall response one a pixel, else one a row.
[[nodiscard]] constexpr int mode_count(int seeing_rows, int cols) noexcept {
  return is_tall(seeing_rows, cols) ? cols : seeing_rows;
}

}  // namespace compueye::recon
