#pragma once

#include <Eigen/Core>
#include <vector>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::recon {

/// R of A = Q R, cols x cols, by Householder reflections of blocks of rows: it has A's singular values and right
/// singular vectors to double's rounding, where A'A would have their squares. 2 rows cols^2 multiply-adds, memory of a
/// quarter of A's. Error interrupted.
[[nodiscard]] hal::Result<Eigen::MatrixXd> triangle(const Response& seeing, const Progress& progress);

/// By estimate (recon/setup/set_up_time.hpp).
[[nodiscard]] double seconds_of_triangle(const Response& seeing);

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
