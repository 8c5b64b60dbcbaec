#include "calib/pixel_coverage.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/calib/cone_reference.hpp"

using namespace compueye;
using namespace compueye::calib;
using reference::Cone;
using reference::deg;
using reference::Pixel;

namespace {

ConeSection section_of(const Cone& c) {
  return {c.apex, c.axis, c.half_angle_rad, c.plane_z};
}

double covered(const Cone& c, const Pixel& p) {
  const ConeSection s = section_of(c);
  return coverage(s, {p.x0 - s.vertex_x_mm(), p.x1 - s.vertex_x_mm(), p.y0 - s.vertex_y_mm(), p.y1 - s.vertex_y_mm()});
}

struct Case {
  Cone cone;
  Pixel pixel;
};

// Cones of every kind, and pixels on their border. Tilts crowd about the parabola from 0.1 rad down to rounding, and
// leans about the axes, where coefficients vanish.
std::vector<Case> border_cases(std::uint64_t seed, int count) {
  reference::Random random(seed);
  std::vector<Case> cases;
  while (static_cast<int>(cases.size()) < count) {
    const int n = static_cast<int>(cases.size());
    const double half = n % 7 == 0 ? random.log_uniform(1e-4, 0.01) : random.uniform(0.5 * deg, 60.0 * deg);
    const double height = random.log_uniform(1e-3, 50.0);
    const double parabola = 90.0 * deg - half;
    double tilt = 0.0;
    if (n % 3 == 0) tilt = random.uniform(0.0, parabola);
    if (n % 3 == 1) tilt = parabola + (random.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0) * random.log_uniform(1e-17, 0.1);
    if (n % 3 == 2) tilt = random.uniform(parabola, 90.0 * deg + half);
    double lean = random.uniform(-180.0 * deg, 180.0 * deg);
    if (n % 5 == 0) lean = 90.0 * deg * std::floor(random.uniform(-2.0, 2.0));
    if (n % 5 == 1)
      lean = 45.0 * deg + 90.0 * deg * std::floor(random.uniform(-2.0, 2.0)) + random.log_uniform(1e-16, 0.1);
    const Cone cone = reference::leaning_cone(tilt, lean, half, height);
    const double size = height * std::tan(half) * random.log_uniform(0.02, 5.0);
    const auto pixel =
        reference::border_pixel(cone, random.uniform(0.0, 360.0 * deg), size, size * random.uniform(0.5, 2.0), random);
    if (pixel) cases.push_back({cone, *pixel});
  }
  return cases;
}

// Pixels on the border of cones whose section is a parabola to the last bit, or a hyperbola with an asymptote along a
// pixel's side: there the coefficients of squares vanish.
std::vector<Case> degenerate_cases(std::uint64_t seed, int count) {
  reference::Random random(seed);
  std::vector<Case> cases;
  while (static_cast<int>(cases.size()) < count) {
    const int n = static_cast<int>(cases.size());
    const double half = random.uniform(5.0 * deg, 60.0 * deg);
    const double cosine = std::cos(half), sine = std::sin(half);
    const double rest = sine * random.uniform(0.1, 0.9);  // of x and z beside y = cos(half angle)
    Cone cone = reference::leaning_cone(0.0, 0.0, half, 10.0);
    switch (n % 6) {
      case 0:
        cone.axis = {cosine, 0.0, sine};
        break;
      case 1:
        cone.axis = {-cosine, 0.0, sine};
        break;
      case 2:
        cone.axis = {0.0, cosine, sine};
        break;
      case 3:
        cone.axis = {0.0, -cosine, sine};
        break;
      case 4:
        cone.axis = {std::sqrt(sine * sine - rest * rest), n % 4 == 0 ? cosine : -cosine, rest};
        break;
      default:
        cone.axis = {n % 4 == 1 ? cosine : -cosine, std::sqrt(sine * sine - rest * rest), rest};
    }
    const double size = 10.0 * std::tan(half) * random.log_uniform(0.02, 5.0);
    const auto pixel = reference::border_pixel(cone, random.uniform(0.0, 360.0 * deg), size, size, random);
    if (pixel) cases.push_back({cone, *pixel});
  }
  return cases;
}

}  // namespace

TEST_CASE("coverage is exact at the parabola and along asymptotes") {
  int parabolas = 0;
  for (const Case& c : degenerate_cases(6, 90)) {
    const double truth = reference::QuadratureCoverage(c.cone, c.pixel).fraction(14);
    CAPTURE(c.cone.axis.x);
    CAPTURE(c.cone.axis.y);
    CHECK(std::abs(covered(c.cone, c.pixel) - truth) <= 1e-10 * truth);
    if (section_of(c.cone).kind() == SectionKind::parabola) ++parabolas;
  }
  CHECK(parabolas == 60);
}

TEST_CASE("a pixel without a border in it is covered by all or nothing") {
  const Cone c = reference::leaning_cone(20.0 * deg, 0.7, 30.0 * deg, 10.0);
  const hal::Vec3 d = c.axis;
  const double x = c.apex.x + 10.0 * d.x / d.z, y = c.apex.y + 10.0 * d.y / d.z;
  CHECK(covered(c, {x - 0.1, x + 0.1, y - 0.1, y + 0.1}) == 1.0);
  CHECK(covered(c, {x + 100.0, x + 100.1, y, y + 0.1}) == 0.0);
  CHECK(covered(c, {x, x + 0.1, y + 100.0, y + 100.1}) == 0.0);
  CHECK(covered(reference::leaning_cone(180.0 * deg, 0.7, 30.0 * deg, 10.0), {x - 0.1, x + 0.1, y - 0.1, y + 0.1}) ==
        0.0);
}

TEST_CASE("coverage agrees with dense sampling of the cone itself") {
  constexpr int n = 160;
  std::array<int, 4> kinds{};
  for (const Case& c : border_cases(1, 400)) {
    const double exact = covered(c.cone, c.pixel);
    CAPTURE(c.cone.half_angle_rad);
    CAPTURE(std::acos(c.cone.axis.z));
    CAPTURE(c.cone.axis.x);
    CAPTURE(c.cone.axis.y);
    CHECK(exact >= 0.0);
    CHECK(exact <= 1.0);
    CHECK(std::abs(exact - reference::sampled_coverage(c.cone, c.pixel, n)) <= 2.0 / n);
    ++kinds[static_cast<std::size_t>(section_of(c.cone).kind())];
  }
  CHECK(kinds[static_cast<std::size_t>(SectionKind::ellipse)] >= 50);
  CHECK(kinds[static_cast<std::size_t>(SectionKind::hyperbola)] >= 50);
}

TEST_CASE("coverage agrees with high-order quadrature of the cone to 1e-8 and better") {
  double worst_absolute = 0.0, worst_relative = 0.0, worst_reference = 0.0;
  for (const Case& c : border_cases(2, 60)) {
    const double exact = covered(c.cone, c.pixel);
    const reference::QuadratureCoverage quadrature(c.cone, c.pixel);
    const double truth = quadrature.fraction(20);
    CAPTURE(c.cone.half_angle_rad / deg);
    CAPTURE(std::acos(c.cone.axis.z) / deg);
    CAPTURE(truth);
    CHECK(std::abs(exact - truth) <= 1e-8 * truth);
    worst_absolute = std::max(worst_absolute, std::abs(exact - truth));
    worst_relative = std::max(worst_relative, std::abs(exact - truth) / truth);
    worst_reference = std::max(worst_reference, std::abs(truth - quadrature.fraction(12)));
  }
  MESSAGE("worst absolute error " << worst_absolute << ", worst relative error " << worst_relative
                                  << ", reference against itself at fewer nodes " << worst_reference);
}
