#include "calib/cone_section.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/calib/cone_reference.hpp"

using namespace compueye;
using namespace compueye::calib;
using reference::Cone;
using reference::deg;

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

ConeSection section(const Cone& c) {
  return {c.apex, c.axis, c.half_angle_rad, c.plane_z};
}

// Angle between the axis and the ray to a point of the plane that is given from the section's vertex.
double angle_at(const Cone& c, const ConeSection& s, double x, double y) {
  return static_cast<double>(reference::angle_to_axis<long double>(c, static_cast<long double>(x) + s.vertex_x_mm(),
                                                                   static_cast<long double>(y) + s.vertex_y_mm()));
}

}  // namespace

TEST_CASE("an upright cone gives a circle of radius h tan(half angle)") {
  const Cone c = reference::leaning_cone(0.0, 0.0, 30.0 * deg, 10.0);
  const ConeSection s = section(c);
  const double radius = 10.0 * std::tan(30.0 * deg);
  CHECK(s.kind() == SectionKind::ellipse);
  CHECK(s.eccentricity() == 0.0);
  CHECK(s.area_mm2() == doctest::Approx(std::numbers::pi * radius * radius).epsilon(1e-14));
  CHECK(s.x_extent().hi - s.x_extent().lo == doctest::Approx(2.0 * radius).epsilon(1e-14));
  CHECK(s.y_extent().hi - s.y_extent().lo == doctest::Approx(2.0 * radius).epsilon(1e-14));
  CHECK(s.x_extent().lo + s.vertex_x_mm() == doctest::Approx(c.apex.x - radius).epsilon(1e-14));
}

TEST_CASE("the tilt decides the kind of section") {
  const double half = 30.0 * deg;
  CHECK(section(reference::leaning_cone(59.9 * deg, 1.0, half, 10.0)).kind() == SectionKind::ellipse);
  CHECK(section(reference::leaning_cone(60.1 * deg, 1.0, half, 10.0)).kind() == SectionKind::hyperbola);
  CHECK(section(reference::leaning_cone(119.9 * deg, 1.0, half, 10.0)).kind() == SectionKind::hyperbola);
  CHECK(section(reference::leaning_cone(120.1 * deg, 1.0, half, 10.0)).empty());
  CHECK(section(reference::leaning_cone(180.0 * deg, 1.0, half, 10.0)).empty());

  const ConeSection exact({0.0, 0.0, 0.0}, {std::cos(half), 0.0, std::sin(half)}, half, 10.0);
  CHECK(exact.kind() == SectionKind::parabola);
  CHECK(exact.area_mm2() == unbounded);
  CHECK(exact.x_extent().hi == unbounded);
  CHECK(exact.y_extent().lo == -unbounded);
}

TEST_CASE("a section without sense is empty, and an empty one has no chords") {
  const hal::Vec3 up{0.0, 0.0, 1.0};
  for (const ConeSection& s :
       {ConeSection({0.0, 0.0, 5.0}, up, 0.5, 5.0), ConeSection({0.0, 0.0, 5.0}, up, 0.5, 4.0),
        ConeSection({0.0, 0.0, 0.0}, up, not_a_number, 5.0), ConeSection({not_a_number, 0.0, 0.0}, up, 0.5, 5.0),
        ConeSection({0.0, 0.0, 0.0}, {not_a_number, 0.0, 1.0}, 0.5, 5.0),
        ConeSection({0.0, 0.0, 0.0}, up, 0.5, unbounded), ConeSection({0.0, 0.0, 0.0}, up, 0.5, not_a_number)}) {
    CHECK(s.empty());
    CHECK(s.area_mm2() == 0.0);
    CHECK(s.x_extent().empty());
    CHECK(s.y_extent().empty());
    CHECK(s.chord_at_x(0.0).empty());
    CHECK(s.chord_at_y(0.0).empty());
  }
}

TEST_CASE("the ends of every chord lie on the cone and its middle inside") {
  reference::Random random(3);
  int finite_ends = 0;
  for (int n = 0; n < 2000; ++n) {
    const double half = random.uniform(1.0 * deg, 60.0 * deg);
    const double tilt = n % 2 == 0 ? random.uniform(0.0, 90.0 * deg + 0.9 * half)
                                   : 90.0 * deg - half + random.uniform(-1.0, 1.0) * random.log_uniform(1e-16, 1e-2);
    const Cone c = reference::leaning_cone(tilt, random.uniform(-180.0 * deg, 180.0 * deg), half, 10.0);
    const ConeSection s = section(c);
    const bool along_y = n % 3 != 0;
    const Interval extent = along_y ? s.x_extent() : s.y_extent();
    const double at = random.uniform(std::max(extent.lo, -50.0), std::min(extent.hi, 50.0));
    const Interval chord = along_y ? s.chord_at_x(at) : s.chord_at_y(at);
    if (chord.empty()) continue;
    CAPTURE(tilt / deg);
    CAPTURE(half / deg);
    CAPTURE(at);
    const auto angle = [&](double across) { return along_y ? angle_at(c, s, at, across) : angle_at(c, s, across, at); };
    for (const double end : {chord.lo, chord.hi}) {
      if (std::abs(end) > 1e4) continue;
      ++finite_ends;
      CHECK(std::abs(angle(end) - half) <= 1e-10);
    }
    CHECK(angle(0.5 * (std::max(chord.lo, -1e4) + std::min(chord.hi, 1e4))) <= half + 1e-10);
  }
  CHECK(finite_ends > 2000);
}

TEST_CASE("the extent is where vertical lines begin to meet the section") {
  reference::Random random(4);
  for (int n = 0; n < 200; ++n) {
    const double half = random.uniform(2.0 * deg, 60.0 * deg);
    const Cone c = reference::leaning_cone(random.uniform(0.0, 89.0 * deg - half),
                                           random.uniform(-180.0 * deg, 180.0 * deg), half, 10.0);
    const ConeSection s = section(c);
    REQUIRE(s.kind() == SectionKind::ellipse);
    const Interval xs = s.x_extent();
    const double width = xs.hi - xs.lo;
    CHECK(s.chord_at_x(xs.lo - 1e-9 * width).empty());
    CHECK(s.chord_at_x(xs.hi + 1e-9 * width).empty());
    const Interval tip = s.chord_at_x(xs.lo + 1e-9 * width);
    REQUIRE_FALSE(tip.empty());
    // A chord that close to the tip is a thousandth of the section: sqrt(1e-9) of its size.
    CHECK(tip.hi - tip.lo < 1e-3 * (s.y_extent().hi - s.y_extent().lo));
  }
}

TEST_CASE("the two halves of an ellipse add up to its area") {
  reference::Random random(5);
  for (int n = 0; n < 500; ++n) {
    const double half = random.log_uniform(1e-6, 1.0);
    const Cone c = reference::leaning_cone(random.uniform(0.0, 0.98 * (90.0 * deg - half)),
                                           random.uniform(-180.0 * deg, 180.0 * deg), half, 10.0);
    const ConeSection s = section(c);
    REQUIRE(s.kind() == SectionKind::ellipse);
    const Interval xs = s.x_extent();
    const Interval a = s.chord_at_x(xs.lo), b = s.chord_at_x(xs.hi);
    const double ya = 0.5 * (a.lo + a.hi), yb = 0.5 * (b.lo + b.hi);
    const double area =
        s.area_beyond_chord(xs.lo, ya, xs.hi, yb, true) + s.area_beyond_chord(xs.lo, ya, xs.hi, yb, false);
    CHECK(area == doctest::Approx(s.area_mm2()).epsilon(1e-11));
  }
}
