#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::recon {

/// So many more rows than pixels that what is cubic, or square in memory, is made on the side of the pixels.
[[nodiscard]] constexpr bool is_tall(std::size_t rows, std::size_t cols) noexcept {
  return rows >= 2 * cols;
}
[[nodiscard]] bool is_tall(const Response& seeing) noexcept;

/// How many modes A A' has: of a tall response one a pixel, else one a row.
[[nodiscard]] int mode_count(int seeing_rows, int cols) noexcept;

/// R of A = Q R, cols x cols, by Householder reflections of blocks of rows: it has A's singular values and right
/// singular vectors to double's rounding, where A'A would have their squares. 2 rows cols^2 multiply-adds, memory of a
/// quarter of A's. Error interrupted.
[[nodiscard]] hal::Result<Eigen::MatrixXd> triangle(const Response& seeing, const Progress& progress);

/// Singular values of a tall response, largest first, and its right singular vectors, column by column. Error
/// interrupted.
struct RightPairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
[[nodiscard]] hal::Result<RightPairs> right_pairs(const Response& seeing, const Progress& progress);

/// A times `columns` (cols x any), row-major, rounded once to T. Error interrupted.
template <class T>
[[nodiscard]] hal::Result<std::vector<T>> rows_times(const Response& seeing, const Eigen::MatrixXd& columns,
                                                     const Progress& progress);

}  // namespace compueye::recon
