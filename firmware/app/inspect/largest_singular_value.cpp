#include "firmware/app/inspect/largest_singular_value.hpp"

#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace compueye::firmware {
namespace {

constexpr int most_iterations = 300;
constexpr double settled_change = 1e-9;

double norm(std::span<const double> v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

/// No symmetry, no zeros and no period, so that it is orthogonal to no singular vector that a real eye has.
std::vector<double> start(std::size_t size) {
  constexpr double golden = 0.6180339887498949;
  std::vector<double> v(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double turns = golden * static_cast<double>(i + 1);
    v[i] = 0.5 + (turns - std::floor(turns));
  }
  return v;
}

}  // namespace

SingularValue largest_singular_value(const recon::Response& a, const recon::Progress& progress) {
  SingularValue found;
  std::vector<double> x = start(static_cast<std::size_t>(a.cols()));
  std::vector<double> y(static_cast<std::size_t>(a.rows()));
  while (found.iterations < most_iterations && !found.settled) {
    const double length = norm(x);
    if (!(length > 0.0) || !std::isfinite(length)) break;
    for (double& each : x) each /= length;
    a.forward(x, y);
    const double before = found.value;
    found.value = norm(y);
    ++found.iterations;
    found.settled = std::abs(found.value - before) <= settled_change * found.value;
    a.adjoint(y, x);
    if (progress && !progress("largest singular value", found.iterations, most_iterations)) break;
  }
  return found;
}

}  // namespace compueye::firmware
