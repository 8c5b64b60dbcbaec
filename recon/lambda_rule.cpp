#include "recon/lambda_rule.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace compueye::recon {
namespace {

/// Fitted by bench/lambda_rule on its tuning scenes.
constexpr double pixel_factor = 1.1;
constexpr double overlap_factor = 0.002;
constexpr double expected_pixel_deviation = 0.35;
/// Even without noise a little shrinkage keeps directions that the eye does not see from running away.
constexpr double least_share_of_scale = 1e-6;

double median_column_norm(const Response& response) {
  std::vector<double> squares(static_cast<std::size_t>(response.cols()), 0.0);
  for (int m = 0; m < response.rows(); ++m) {
    response.for_each_in_row(m, [&](std::int32_t k, double v) { squares[static_cast<std::size_t>(k)] += v * v; });
  }
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle);
}

double mean_overlap(const Response& response) {
  double sum = 0.0;
  for (const double v : response.values()) sum += std::abs(v);
  return sum / response.cols();
}

}  // namespace

double lambda_scale(const Response& response, BasisKind basis) {
  return basis == BasisKind::identity ? median_column_norm(response) : mean_overlap(response);
}

hal::Result<double> lambda_by_rule(const Response& response, SolverKind solver, BasisKind basis, double sigma) {
  if (!std::isfinite(sigma) || sigma < 0.0) {
    return hal::fail(hal::ErrorCode::out_of_range, "sigma",
                     "is " + std::to_string(sigma) + ", expected a finite number of 0 or more");
  }
  const double scale = lambda_scale(response, basis);
  const double size = scale > 0.0 ? scale : 1.0;
  if (solver == SolverKind::tikhonov || solver == SolverKind::tsvd) {
    const double deviation = std::max(sigma / expected_pixel_deviation, least_share_of_scale * size);
    return deviation * deviation;
  }
  const double factor = basis == BasisKind::identity ? pixel_factor : overlap_factor;
  return std::max(factor * sigma * size, least_share_of_scale * size * size);
}

}  // namespace compueye::recon
