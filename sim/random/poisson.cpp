#include "sim/random/poisson.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::sim {
namespace {

double inverted(double u, double mean) noexcept {
  constexpr double last = 300.0;  // beyond all that 53 bits tell apart
  double term = std::exp(-mean), sum = term, k = 0.0;
  while (u >= sum && k < last) {
    k += 1.0;
    term *= mean / k;
    sum += term;
  }
  return k;
}

}  // namespace

double poisson_at(double w, double mean) noexcept {
  const double root = std::sqrt(mean), w2 = w * w;
  const double quantile = mean + root * w + (1.0 / 3.0 + w2 / 6.0) - w * (1.0 / 36.0 + w2 / 72.0) / root +
                          (-8.0 / 405.0 + w2 * (7.0 / 810.0 + w2 / 270.0)) / mean;
  return std::max(std::floor(quantile), 0.0);
}

double poisson(RandomStream& random, double mean) noexcept {
  if (!(mean > 0.0)) return 0.0;
  return mean < poisson_exact_below ? inverted(random.uniform(), mean) : poisson_at(random.gaussian(), mean);
}

}  // namespace compueye::sim
