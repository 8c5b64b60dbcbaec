#include "sim/effects/profile_stack.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

using namespace compueye;
using namespace compueye::sim;

namespace {

/// What a flat disc of radius r about the axis sees of a picture; relative to (D/2)^2.
struct Picture {
  std::string name;
  std::function<double(double)> within;
};

/// Area of a disc right of a line at distance d from its middle.
double segment(double r, double d) {
  if (d >= r) return 0.0;
  if (d <= -r) return std::numbers::pi * r * r;
  return r * r * std::acos(d / r) - d * std::sqrt(r * r - d * d);
}

/// A white square of sides 8 about the axis: nothing beyond, as of an object plane.
double square(double r) {
  return std::numbers::pi * r * r - 4.0 * segment(r, 4.0);
}

std::vector<Picture> pictures() {
  return {{"white square", [](double r) { return r < 4.0 * std::numbers::sqrt2 ? square(r) : 64.0; }},
          {"spot", [](double r) { return std::numbers::pi / 2.0 * (1.0 - std::exp(-2.0 * r * r)); }},
          {"stripe", [](double r) { return segment(r, -0.4) - segment(r, 0.5); }},
          {"stripe at the rim", [](double r) { return segment(r, 0.8) - segment(r, 1.2); }},
          {"edge", [](double r) { return segment(r, 0.5) - segment(r, 4.0); }},
          {"edge outside", [](double r) { return segment(r, 1.5) - segment(r, 5.0); }}};
}

/// Integral of the profile over the picture: the profile's value times what each thin ring adds.
double exact(const std::function<double(double)>& profile, const Picture& picture, double widest) {
  constexpr int rings = 200000;
  double sum = 0.0, before = 0.0;
  for (int k = 0; k < rings; ++k) {
    const double now = picture.within(widest * (k + 1) / rings);
    sum += profile(widest * (k + 0.5) / rings) * (now - before);
    before = now;
  }
  return sum;
}

void check_stack(const std::vector<ProfileShell>& stack, const std::function<double(double)>& profile, double widest,
                 double tolerance) {
  for (const Picture& picture : pictures()) {
    double told = 0.0;
    for (const ProfileShell& shell : stack) told += shell.weight * picture.within(shell.ratio);
    CAPTURE(picture.name);
    CHECK(std::fabs(told - exact(profile, picture, widest)) < tolerance * std::numbers::pi);
  }
}

}  // namespace

TEST_CASE("a flat top is one cone") {
  const auto stack = profile_stack(hal::ProfileKind::flat_top, 8.0, 10.0);
  REQUIRE(stack.size() == 1);
  CHECK(stack[0].ratio == 1.0);
  CHECK(stack[0].weight == 1.0);
}

TEST_CASE("soft profiles are stacks of cones to 0.2 % of white") {
  for (const double order : {1.0, 2.0, 4.0, 8.0, 20.0, 64.0}) {
    CAPTURE(order);
    const auto profile = [&](double a) { return std::exp(-std::numbers::ln2 * std::pow(a, order)); };
    check_stack(profile_stack(hal::ProfileKind::soft, order, 15.0), profile, 15.0, 0.002);
  }
}

TEST_CASE("an Airy disc with its rings is a stack of cones to 0.2 % of white") {
  const auto profile = [](double a) {
    const double u = 1.616339948 * a;
    return std::pow(2.0 * std::cyl_bessel_j(1.0, u) / u, 2);
  };
  check_stack(profile_stack(hal::ProfileKind::airy, 8.0, 15.0), profile, 15.0, 0.002);
}

TEST_CASE("light and width of a soft profile are the gamma function's") {
  for (const double order : {2.0, 8.0}) {
    const ProfileMoments told = moments(profile_stack(hal::ProfileKind::soft, order, 100.0));
    const double scale = std::pow(std::numbers::ln2, -2.0 / order);
    const double light = scale * std::tgamma(1.0 + 2.0 / order);
    CHECK(told.light == doctest::Approx(light).epsilon(0.002));
    CHECK(told.square == doctest::Approx(scale * std::tgamma(4.0 / order) / std::tgamma(2.0 / order)).epsilon(0.01));
  }
}
