#include "recon/core/parts/proximal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/recon/random_problem.hpp"

using namespace compueye;
using recon::core::prox_l1_box;

TEST_CASE("Moreau: t = prox_f(t) + prox_f*(t) for the l1 norm") {
  tests::Random random(31);
  for (int trial = 0; trial < 2000; ++trial) {
    const double t = random.uniform(-5, 5), threshold = random.uniform(0, 3);
    const double conjugate = std::clamp(t, -threshold, threshold);  // projection onto the dual ball
    CHECK(prox_l1_box(t, threshold, -1e30, 1e30) + conjugate == doctest::Approx(t).epsilon(1e-14));
  }
}

TEST_CASE("the joint map of l1 and box minimises their sum") {
  tests::Random random(32);
  for (int trial = 0; trial < 500; ++trial) {
    const double t = random.uniform(-3, 3), threshold = random.uniform(0, 2);
    const double a = random.uniform(-2, 2), b = random.uniform(-2, 2);
    const double lo = std::min(a, b), hi = std::max(a, b);
    const auto cost = [&](double x) { return 0.5 * (x - t) * (x - t) + threshold * std::abs(x); };
    const double found = prox_l1_box(t, threshold, lo, hi);
    CHECK(found >= lo);
    CHECK(found <= hi);
    for (int k = 0; k <= 200; ++k) CHECK(cost(found) <= cost(lo + (hi - lo) * k / 200.0) + 1e-12);
  }
}

TEST_CASE("a prox step keeps t = z + u and makes no subnormal numbers") {
  tests::Random random(33);
  std::vector<float> x(300), z(300), u(300);
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = static_cast<float>(random.uniform(-1, 1));
    z[k] = static_cast<float>(random.uniform(0, 1));
    u[k] = static_cast<float>(random.uniform(-1, 1));
  }
  const auto before_z = z, before_u = u;
  recon::core::relaxed_prox_step(x.data(), z.data(), u.data(), x.size(), 1.7F, 0.25F, 0.0F, 1.0F);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = 1.7 * x[k] - 0.7 * before_z[k] + before_u[k];
    CHECK(static_cast<double>(z[k]) + static_cast<double>(u[k]) == doctest::Approx(t).epsilon(1e-5));
    CHECK(z[k] >= 0.0F);
    CHECK(z[k] <= 1.0F);
  }
  std::vector<float> faint(64, 1e-30F), zero(64, 0.0F), dual(64, 1e-39F);
  recon::core::relaxed_prox_step(faint.data(), zero.data(), dual.data(), 64, 1.0F, 0.0F, -1.0F, 1.0F);
  for (std::size_t k = 0; k < 64; ++k) {
    CHECK(zero[k] == 0.0F);
    CHECK(dual[k] == 0.0F);
  }
}
