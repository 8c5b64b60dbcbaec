#include "recon/setup/step_sizes.hpp"

#include <cmath>
#include <numeric>
#include <random>
#include <utility>

namespace compueye::recon {
namespace {

/// Mean dual step of A's rows. Duals of A x are residuals, a few hundredths of what the rows read, while x is of size
/// one; with .02 and
/// .03 every test problem meets its reference within 5000 iterations, with .01 or .05 some do not.
constexpr double dual_share = 0.02;

double norm(const std::vector<double>& v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

/// The power method on A'A from x.
double squared_norm_from(const Response& response, std::vector<double> x) {
  std::vector<double> y(static_cast<std::size_t>(response.rows()));
  double squared = 0.0;
  for (int iteration = 0; iteration < 500; ++iteration) {
    const double size = norm(x);
    if (!(size > 0.0)) return 0.0;
    for (double& v : x) v /= size;
    response.forward(x, y);
    response.adjoint(y, x);
    const double grown = norm(x);
    const bool settled = std::abs(grown - squared) <= 1e-6 * grown;
    squared = grown;
    if (settled && iteration > 10) break;
  }
  return squared;
}

}  // namespace

double squared_norm_bound(const Response& response) {
  // Entries are mostly positive, so the leading vector is too, and this is near it.
  std::vector<double> positive(static_cast<std::size_t>(response.cols())), any = positive;
  for (std::size_t k = 0; k < positive.size(); ++k) positive[k] = 1.0 + 0.1 * std::sin(0.7 * static_cast<double>(k));
  // That of a signed response may be orthogonal to any start but one drawn without regard to it.
  std::mt19937_64 draw(20);
  for (double& v : any) v = static_cast<double>(draw() >> 11U) * 0x1p-53 - 0.5;
  const double usual = squared_norm_from(response, std::move(positive));
  const double other = squared_norm_from(response, std::move(any));
  return 1.01 * (other > 1.001 * usual ? other : usual);  // one picture's bits do not hang on which of two equals
}

PrimalDualSteps primal_dual_steps(const Response& seeing, double basis_squared_norm) {
  PrimalDualSteps steps;
  steps.primal.assign(static_cast<std::size_t>(seeing.cols()), 0.0);
  double total = 0.0;
  for (int m = 0; m < seeing.rows(); ++m) {
    double row = 0.0;
    seeing.for_each_in_row(m, [&](std::int32_t n, double v) {
      row += std::abs(v);
      steps.primal[static_cast<std::size_t>(n)] += std::abs(v);
    });
    steps.dual.push_back(1.0 / row);
    total += row;
  }
  const double mean = total / seeing.cols();
  const double mean_row = total / seeing.rows();
  const double balance = dual_share * mean_row;
  for (double& column : steps.primal) column = 1.0 / (balance * (column + mean));
  for (double& row : steps.dual) row *= balance;
  steps.basis = balance * mean / basis_squared_norm;
  return steps;
}

}  // namespace compueye::recon
