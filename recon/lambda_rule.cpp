#include "recon/lambda_rule.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "recon/atom_norms.hpp"

namespace compueye::recon {
namespace {

constexpr double pixel_factor = 1.1;
constexpr double fourier_factor = 0.4;
constexpr double wavelet_factor = 0.4;
constexpr double difference_factor = 0.4;
constexpr double expected_pixel_deviation = 0.35;
/// Even without noise a little shrinkage keeps directions that the eye does not see from running away.
constexpr double least_share_of_norm = 1e-6;

/// c of each basis, fitted by bench/lambda_rule.cpp on its tuning scenes.
double factor_of(BasisKind basis) noexcept {
  switch (basis) {
    case BasisKind::identity:
      return pixel_factor;
    case BasisKind::dct:
    case BasisKind::dft:
      return fourier_factor;
    case BasisKind::haar:
    case BasisKind::db4:
      return wavelet_factor;
    case BasisKind::tv:
      return difference_factor;
  }
  return pixel_factor;
}

}  // namespace

double median_atom_norm(const Response& response, int image_rows, int image_cols, BasisKind basis) {
  std::vector<double> norms = atom_norms(response, image_rows, image_cols, basis);
  const auto middle = norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2);
  std::nth_element(norms.begin(), middle, norms.end());
  return *middle;
}

hal::Result<double> lambda_by_rule(const Response& response, int image_rows, int image_cols, SolverKind solver,
                                   BasisKind basis, double sigma) {
  return lambda_by_rule(median_atom_norm(response, image_rows, image_cols, basis), solver, basis, sigma);
}

hal::Result<double> lambda_by_rule(double atom_norm, SolverKind solver, BasisKind basis, double sigma) {
  if (!std::isfinite(sigma) || sigma < 0.0) {
    return hal::fail(hal::ErrorCode::out_of_range, "sigma",
                     "is " + std::to_string(sigma) + ", expected a finite number of 0 or more");
  }
  const double size = atom_norm > 0.0 ? atom_norm : 1.0;
  if (solver == SolverKind::tikhonov || solver == SolverKind::tsvd) {
    const double deviation = std::max(sigma / expected_pixel_deviation, least_share_of_norm * size);
    return deviation * deviation;
  }
  return std::max(factor_of(basis) * sigma * size, least_share_of_norm * size * size);
}

}  // namespace compueye::recon
