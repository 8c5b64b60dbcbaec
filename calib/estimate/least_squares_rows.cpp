#include "calib/estimate/least_squares_rows.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <string>

#include "calib/estimate/cone_fit.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

/// Of the factor's diagonal, smallest over largest: below it, patterns in float do not tell all pixels apart.
constexpr double least_pivot = 1e-5;

}  // namespace

hal::Result<std::vector<RowEstimate>> least_squares_rows(const LightSamples& samples, const ShownPatterns& patterns,
                                                         int pixels) {
  if (pixels > least_squares_most_pixels || pixels > patterns.count()) {
    return fail(ErrorCode::unsupported, "least squares",
                "of " + std::to_string(pixels) + " pixels from " + std::to_string(patterns.count()) +
                    " patterns, expected at most " + std::to_string(least_squares_most_pixels) +
                    " pixels and as many patterns: take the hybrid method");
  }
  Eigen::MatrixXd shown(patterns.count(), pixels);
  for (int n = 0; n < pixels; ++n) shown.col(n) = patterns.pixel(n).cast<double>();
  const Eigen::LLT<Eigen::MatrixXd> factor(shown.transpose() * shown);
  const Eigen::VectorXd pivots = Eigen::MatrixXd(factor.matrixL()).diagonal();
  if (factor.info() != Eigen::Success || !(pivots.minCoeff() > least_pivot * pivots.maxCoeff())) {
    return fail(ErrorCode::unsupported, "least squares",
                "cannot tell all pixels apart by these patterns, expected a raster or Hadamard patterns, complete");
  }
  const Eigen::VectorXd spread = factor.solve(Eigen::MatrixXd::Identity(pixels, pixels)).diagonal().cwiseSqrt();
  std::vector<RowEstimate> rows(samples.status.size());
  for (std::size_t m = 0; m < rows.size(); ++m) {
    RowEstimate& row = rows[m];
    row.status = samples.status[m];
    const RowSamples read = row_samples(samples, patterns, static_cast<int>(m));
    if (!read.fixed_variance.allFinite() && row.status == ChannelStatus::good) row.status = ChannelStatus::saturated;
    if (row.status != ChannelStatus::good) continue;
    const Eigen::VectorXd entries = factor.solve(shown.transpose() * read.light);
    const double noise = std::sqrt(read.certainty(read.light).cwiseAbs2().cwiseInverse().mean());
    for (int n = 0; n < pixels; ++n) {
      row.columns.push_back(n);
      row.values.push_back(static_cast<float>(entries[n]));
      row.sigmas.push_back(static_cast<float>(noise * spread[n]));
    }
  }
  return rows;
}

}  // namespace compueye::calib
