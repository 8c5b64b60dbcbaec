#include "sim/random/poisson.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <map>

#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::sim;

namespace {

/// Numbers of the given mean, by how often.
std::map<double, int> drawn(double mean, int draws) {
  std::map<double, int> counts;
  for (int n = 0; n < draws; ++n) {
    RandomStream random({7, Draws::picture, static_cast<std::uint64_t>(n), 0});
    ++counts[poisson(random, mean)];
  }
  return counts;
}

/// Largest distance of the distribution functions: of the draws, and exp(-mean) mean^k / k! summed.
double distance(double mean, int draws) {
  const std::map<double, int> counts = drawn(mean, draws);
  double told = 0.0, exact = 0.0, farthest = 0.0;
  const int last = static_cast<int>(counts.rbegin()->first);
  for (int k = 0; k <= last; ++k) {
    exact += std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
    const auto at = counts.find(k);
    if (at != counts.end()) told += static_cast<double>(at->second) / draws;
    farthest = std::max(farthest, std::fabs(told - exact));
  }
  return farthest;
}

}  // namespace

TEST_CASE("Poisson numbers have the Poisson distribution, below and above where the expansion begins") {
  // Kolmogorov: a right distribution is farther than 1.95 / sqrt n once in 1000.
  const int draws = test::sanitized ? 20000 : 200000;
  for (const double mean : {0.01, 0.7, 4.0, 31.9, 32.0, 33.3, 80.0, 1000.0}) {
    CAPTURE(mean);
    CHECK(distance(mean, draws) < 1.95 / std::sqrt(draws));
  }
}

TEST_CASE("the expansion's distribution function is within its stated error, not only within that of draws") {
  // The normal w at which the number goes from k to k + 1, by bisection; its share below by erfc.
  const double mean = poisson_exact_below;
  double exact = 0.0;
  for (int k = 0; k < 80; ++k) {
    exact += std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
    if (exact < 1e-9 || exact > 1.0 - 1e-9) continue;
    double lo = -8.0, hi = 8.0;
    for (int halved = 0; halved < 60; ++halved) {
      const double w = (lo + hi) / 2.0;
      (poisson_at(w, mean) <= k ? lo : hi) = w;
    }
    CAPTURE(k);
    CHECK(std::fabs(std::erfc(-lo / std::sqrt(2.0)) / 2.0 - exact) < 1e-5);
  }
}

TEST_CASE("no light and no number give no electrons") {
  RandomStream random({1, Draws::picture, 0, 0});
  CHECK(poisson(random, 0.0) == 0.0);
  CHECK(poisson(random, -5.0) == 0.0);
  CHECK(poisson(random, std::numeric_limits<double>::quiet_NaN()) == 0.0);
  const double many = poisson(random, 1e12);
  CHECK(std::fabs(many - 1e12) < 1e7);
  CHECK(many == std::floor(many));
}
