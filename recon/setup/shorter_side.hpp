#pragma once

#include <cstddef>

#include "recon/core/operators/linear_operator.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// As core::is_tall() of the seeing rows.
[[nodiscard]] constexpr bool is_tall(int rows, int cols) noexcept {
  return core::is_tall(static_cast<std::size_t>(rows), static_cast<std::size_t>(cols));
}
[[nodiscard]] inline bool is_tall(const Response& seeing) noexcept {
  return is_tall(seeing.rows(), seeing.cols());
}

/// How many modes A A' has: of a tall response one a pixel, else one a row.
[[nodiscard]] constexpr int mode_count(int seeing_rows, int cols) noexcept {
  return is_tall(seeing_rows, cols) ? cols : seeing_rows;
}

}  // namespace compueye::recon
