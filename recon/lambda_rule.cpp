#include "recon/lambda_rule.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "recon/core/dct.hpp"
#include "recon/dct_tables.hpp"

namespace compueye::recon {
namespace {

constexpr double pixel_factor = 1.1;
constexpr double dct_factor = 0.4;
constexpr double expected_pixel_deviation = 0.35;
/// Even without noise a little shrinkage keeps directions that the eye does not see from running away.
constexpr double least_share_of_norm = 1e-6;

/// Squared norms of A psi_j: those of A's columns, or the sums over its rows' squared transforms.
std::vector<double> squared_atom_norms(const Response& response, int image_rows, int image_cols, BasisKind basis) {
  const auto n = static_cast<std::size_t>(response.cols());
  std::vector<double> squares(n, 0.0), row(n, 0.0);
  if (basis == BasisKind::identity) {
    for (int m = 0; m < response.rows(); ++m) {
      response.for_each_in_row(m, [&](std::int32_t k, double v) { squares[static_cast<std::size_t>(k)] += v * v; });
    }
    return squares;
  }
  const auto rows_table = make_dct_table<double>(image_rows), cols_table = make_dct_table<double>(image_cols);
  const core::Dct2d<double> psi{{static_cast<std::size_t>(image_rows), rows_table.data()},
                                {static_cast<std::size_t>(image_cols), cols_table.data()}};
  std::vector<double> scratch(
      core::dct_scratch_size(static_cast<std::size_t>(image_rows), static_cast<std::size_t>(image_cols)));
  for (const std::int32_t m : response.seeing_rows()) {
    std::fill(row.begin(), row.end(), 0.0);
    response.for_each_in_row(m, [&](std::int32_t k, double v) { row[static_cast<std::size_t>(k)] = v; });
    core::dct_forward(psi, row.data(), row.data(), scratch.data());
    for (std::size_t k = 0; k < n; ++k) squares[k] += row[k] * row[k];
  }
  return squares;
}

}  // namespace

double median_atom_norm(const Response& response, int image_rows, int image_cols, BasisKind basis) {
  std::vector<double> squares = squared_atom_norms(response, image_rows, image_cols, basis);
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle);
}

hal::Result<double> lambda_by_rule(const Response& response, int image_rows, int image_cols, SolverKind solver,
                                   BasisKind basis, double sigma) {
  if (!std::isfinite(sigma) || sigma < 0.0) {
    return hal::fail(hal::ErrorCode::out_of_range, "sigma",
                     "is " + std::to_string(sigma) + ", expected a finite number of 0 or more");
  }
  const double norm = median_atom_norm(response, image_rows, image_cols, basis);
  const double size = norm > 0.0 ? norm : 1.0;
  if (solver == SolverKind::tikhonov) {
    const double deviation = std::max(sigma / expected_pixel_deviation, least_share_of_norm * size);
    return deviation * deviation;
  }
  const double factor = basis == BasisKind::identity ? pixel_factor : dct_factor;
  return std::max(factor * sigma * size, least_share_of_norm * size * size);
}

}  // namespace compueye::recon
