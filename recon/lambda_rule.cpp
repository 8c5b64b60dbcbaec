#include "recon/lambda_rule.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "recon/setup/atom_norms.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {
namespace {

/// Fitted by bench/lambda_rule on its tuning scenes.
constexpr double pixel_factor = 1.1;
constexpr double overlap_factor = 0.002;
constexpr double atom_factor = 0.4;
constexpr double expected_pixel_deviation = 0.35;
/// Even without noise a little shrinkage keeps directions that the eye does not see from running away.
constexpr double least_share_of_scale = 1e-6;

double median_atom_norm(const Response& response, BasisKind basis) {
  std::vector<double> norms = atom_norms(response, basis);
  const auto middle = norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2);
  std::nth_element(norms.begin(), middle, norms.end());
  return *middle;
}

double factor_of(BasisKind basis, bool by_atoms) noexcept {
  if (basis == BasisKind::identity) return pixel_factor;
  return by_atoms ? atom_factor : overlap_factor;
}

double mean_overlap(const Response& response) {
  double sum = 0.0;
  for (const double v : response.values()) sum += std::abs(v);
  return sum / response.cols();
}

}  // namespace

double lambda_scale(const Response& response, BasisKind basis) {
  return basis == BasisKind::identity ? median_atom_norm(response, basis) : mean_overlap(response);
}

hal::Result<double> lambda_by_rule(const Response& response, SolverKind solver, BasisKind basis, double sigma,
                                   double white) {
  if (!std::isfinite(sigma) || sigma < 0.0) {
    return hal::fail(hal::ErrorCode::out_of_range, "sigma",
                     "is " + std::to_string(sigma) + ", expected a finite number of 0 or more");
  }
  const bool by_atoms = solver->lambda == LambdaUse::atoms;
  if (by_atoms && basis != BasisKind::identity && response.image_rows() == 0) {
    return hal::fail(hal::ErrorCode::mismatch, "size",
                     "of the picture is not known, the response has " + std::to_string(response.cols()) + " columns");
  }
  const double scale = by_atoms ? median_atom_norm(response, basis) : lambda_scale(response, basis);
  const double size = scale > 0.0 ? scale : 1.0;
  if (solver->lambda == LambdaUse::variances) {
    const double deviation = std::max(sigma / (expected_pixel_deviation * white), least_share_of_scale * size);
    return deviation * deviation;
  }
  return std::max(factor_of(basis, by_atoms) * sigma * size, least_share_of_scale * size * size * white);
}

double white_of_samples(const Response& response, std::span<const float> y, std::span<const float> weights) {
  constexpr double dimmest = 0x1p-12, brightest = 8.0;
  const std::vector<double> of_white = response.row_sums();
  double squares = 0.0, white_squares = 0.0;
  for (std::size_t m = 0; m < of_white.size(); ++m) {
    if (!weights.empty() && !(weights[m] > 0.0F)) continue;
    if (of_white[m] == 0.0 || !std::isfinite(y[m])) continue;
    squares += static_cast<double>(y[m]) * static_cast<double>(y[m]);
    white_squares += of_white[m] * of_white[m];
  }
  if (!(squares > 0.0) || !(white_squares > 0.0)) return 1.0;
  const double brightness = std::sqrt(squares / white_squares);
  return brightness < dimmest || brightness > brightest ? brightness : 1.0;
}

}  // namespace compueye::recon
