#include "sim/render/cone_section.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "sim/random/random.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using sim::ConeSection;
using sim::Interval;

namespace {

using compueye::test::deg;

// Positive inside: the angle condition itself.
double inside_by(const hal::Vec3& axis, double half_angle, double u, double v, double depth) {
  const double cosine = (u * axis.x + v * axis.y + depth * axis.z) / std::hypot(u, v, depth);
  return half_angle - std::acos(std::fmin(1.0, std::fmax(-1.0, cosine)));
}

void check_chord(const hal::Vec3& axis, double half_angle, double depth, double v) {
  CAPTURE(axis.x);
  CAPTURE(axis.y);
  CAPTURE(axis.z);
  CAPTURE(half_angle / deg);
  CAPTURE(v);
  const ConeSection section(axis, half_angle, depth);
  const Interval chord = section.chord(v);
  const Interval vs = section.v_range();
  CHECK((chord.empty() || (v >= vs.lo - 1e-6 * depth && v <= vs.hi + 1e-6 * depth)));
  for (const double end : {chord.lo, chord.hi}) {
    if (chord.empty() || !std::isfinite(end) || std::fabs(end) > 1e6 * depth) continue;
    CHECK(std::fabs(inside_by(axis, half_angle, end, v, depth)) < 1e-8);
  }
  for (double u = -30.0; u <= 30.0; u += 0.37) {
    const double by = inside_by(axis, half_angle, u * depth, v, depth);
    if (std::fabs(by) < 1e-7) continue;
    const bool within = !chord.empty() && u * depth >= chord.lo && u * depth <= chord.hi;
    CHECK(within == (by > 0.0));
    const Interval us = section.u_range();
    if (within) CHECK((u * depth >= us.lo - 1e-9 * depth && u * depth <= us.hi + 1e-9 * depth));
  }
}

}  // namespace

TEST_CASE("chords agree with the angle between ray and axis, for any axis and acceptance") {
  sim::RandomStream random({1, sim::Draws::picture, 0, 99});
  for (int i = 0; i < 400; ++i) {
    hal::Vec3 d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const double n = std::hypot(d.x, d.y, d.z);
    d = {d.x / n, d.y / n, d.z / n};
    const double depth = random.uniform(0.1, 50.0);
    check_chord(d, random.uniform(0.5, 60.0) * deg, depth, random.uniform(-3, 3) * depth);
  }
}

TEST_CASE("chords of parabolas and of nearly parabolic conics are exact") {
  for (const double off : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, -1e-15, -1e-12, -1e-9, -1e-6, -1e-3}) {
    for (const double side : {-1.0, 1.0}) {
      for (const double tilt : {-0.4, 0.0, 0.4}) {
        const double half_angle = 35.0 * deg;
        const double x = side * (std::cos(half_angle) + off);
        const double rest = std::sqrt(1.0 - x * x);
        for (const double v : {-2.0, -0.3, 0.0, 0.9}) {
          check_chord({x, rest * std::sin(tilt), rest * std::cos(tilt)}, half_angle, 1.0, v);
        }
      }
    }
  }
}

TEST_CASE("a cone that looks backwards meets nothing") {
  const ConeSection section({0.0, 0.0, -1.0}, 60.0 * deg, 1.0);
  CHECK(section.v_range().empty());
  CHECK(section.u_range().empty());
  CHECK(section.chord(0.0).empty());
}

TEST_CASE("a straight cone is a circle") {
  const ConeSection section({0.0, 0.0, 1.0}, 30.0 * deg, 2.0);
  const double radius = 2.0 * std::tan(30.0 * deg);
  CHECK(section.u_range().hi == doctest::Approx(radius));
  CHECK(section.v_range().lo == doctest::Approx(-radius));
  CHECK(section.chord(0.6 * radius).hi == doctest::Approx(0.8 * radius));
  CHECK(section.chord(1.01 * radius).empty());
}
