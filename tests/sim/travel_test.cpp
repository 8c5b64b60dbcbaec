#include "sim/scene/travel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <string>

#include "sim/scene/scene.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using hal::ErrorCode;

namespace {

sim::Surface sheet_of(double width_mm, double height_mm) {
  sim::Surface sheet;
  sheet.name = "sheet";
  sheet.bands = {hal::Image(2, 2, 0.5F)};
  sheet.width_mm = width_mm;
  sheet.height_mm = height_mm;
  return sheet;
}

sim::Scene scene_of(sim::Surface surface) {
  sim::Scene scene;
  scene.name = "some";
  scene.surfaces.push_back(std::move(surface));
  return scene;
}

/// Nearest z of the four corners, each turned by hand (roll about z, lean about x, tilt about y).
double nearest_corner(const sim::Surface& s, const sim::Pose& pose) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const double u : {-0.5, 0.5}) {
    for (const double v : {-0.5, 0.5}) {
      const double x = u * s.width_mm, y = v * s.height_mm;
      const double rx = std::cos(pose.roll_rad) * x - std::sin(pose.roll_rad) * y;
      const double ry = std::sin(pose.roll_rad) * x + std::cos(pose.roll_rad) * y;
      const double lz = std::sin(pose.lean_rad) * ry;
      const double z = std::sin(pose.tilt_rad) * rx + std::cos(pose.tilt_rad) * lz;
      nearest = std::min(nearest, pose.centre_mm.z + z);
    }
  }
  return nearest;
}

}  // namespace

TEST_CASE("how near a surface comes is what looking at it all the time finds") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int round = 0; round < (test::sanitized ? 10 : 60); ++round) {
    CAPTURE(round);
    sim::Surface s = sheet_of(6.0 + any(random), 4.0 + any(random));
    s.distance_mm = 30.0;
    s.pose.tilt_rad = any(random);
    s.pose.lean_rad = any(random);
    s.motion.start_s = 1.0 + any(random);
    s.motion.velocity_mm_per_s = {any(random), any(random), any(random)};
    if (round % 2 == 0) s.motion.tilt_rad_per_s = any(random), s.motion.roll_rad_per_s = any(random);
    if (round % 3 != 0) {
      s.motion.path = {{0.0, {}}, {0.7, {any(random), 0.0, 4.0 * any(random)}}, {1.3, {0.0, 2.0, 3.0 * any(random)}}};
      s.motion.repeats = round % 3 == 1;
    }
    const double seconds = 11.3, limit = 31.0;
    const sim::Travel travel = sim::travel_of(s, 5.0, seconds, limit);
    sim::Pose rest = s.pose;
    rest.centre_mm.z = 30.0;
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
    std::optional<double> too_far_at_s;
    constexpr int looks = 40'000;
    for (int k = 0; k <= looks; ++k) {
      const sim::Pose pose = s.motion.moved(rest, seconds * k / looks);
      nearest = std::min(nearest, nearest_corner(s, pose));
      farthest = std::max({farthest, std::fabs(pose.centre_mm.x), std::fabs(pose.centre_mm.y), pose.centre_mm.z});
      if (farthest > limit && !too_far_at_s) too_far_at_s = seconds * k / looks;
    }
    // A look every degree misses 4 mm (1 - cos 0.5 deg) and what is travelled meanwhile.
    CHECK(travel.nearest_mm == doctest::Approx(nearest).epsilon(0.03 / nearest));
    CHECK(travel.farthest_mm == doctest::Approx(farthest).epsilon(0.01 / farthest));
    CHECK_FALSE(travel.inside_at_s.has_value());
    REQUIRE(travel.too_far_at_s.has_value() == too_far_at_s.has_value());
    if (too_far_at_s) CHECK(std::fabs(*travel.too_far_at_s - *too_far_at_s) < 1e-3);

    // As far away that half of its way towards the eye ends at the lens.
    const double begin = nearest_corner(s, s.motion.moved(rest, 0.0)), half = std::midpoint(begin, nearest);
    if (begin - half < 0.1) continue;
    s.distance_mm = 30.0 - half;
    const std::optional<double> inside_at_s = sim::travel_of(s, 5.0, seconds, 1e6).inside_at_s;
    REQUIRE(inside_at_s.has_value());
    for (int k = 0; seconds * k / looks < *inside_at_s; ++k) {
      CHECK(nearest_corner(s, s.motion.moved(rest, seconds * k / looks)) - half > -0.03);
    }
    CHECK(nearest_corner(s, s.motion.moved(rest, *inside_at_s)) - half <= 1e-6);  // a path that begins anew jumps
  }
}

TEST_CASE("what comes into the eye is refused with the time, what stays before it is not") {
  sim::Surface s = sheet_of(8.0, 8.0);
  s.distance_mm = 30.0;
  s.motion.velocity_mm_per_s = {0.0, 0.0, -2.0};
  sim::Scene scene = scene_of(s);
  scene.duration_s = 14.9;
  CHECK(sim::validate_travel(scene, 30.0).has_value());
  scene.duration_s = 15.1;
  test::check_error(sim::validate_travel(scene, 30.0), ErrorCode::out_of_range, "sheet", {"-0.2", "15.000000", "0"});
  scene.duration_s = 0.0;  // for ever: an hour is looked at
  CHECK_FALSE(sim::validate_travel(scene, 30.0).has_value());

  // Too far as it stands: at 60 degrees its edge comes 4 mm sin 60 = 3.46 mm nearer.
  sim::Surface tilted = sheet_of(8.0, 8.0);
  tilted.pose.tilt_rad = 1.0471975512;
  CHECK(sim::validate_travel(scene_of(tilted), 3.5).has_value());
  CHECK_FALSE(sim::validate_travel(scene_of(tilted), 3.4).has_value());
  sim::Surface ball = sheet_of(8.0, 8.0);
  ball.shape = sim::Shape::sphere;
  CHECK(sim::validate_travel(scene_of(ball), 4.01).has_value());
  CHECK_FALSE(sim::validate_travel(scene_of(ball), 3.99).has_value());
  sim::Surface relief = sheet_of(8.0, 8.0);
  relief.shape = sim::Shape::relief;
  relief.heights = hal::Image(1, 2, 3.0F);
  CHECK(sim::validate_travel(scene_of(relief), 3.01).has_value());
  CHECK_FALSE(sim::validate_travel(scene_of(relief), 2.99).has_value());
}

TEST_CASE("a motion that leaves numbers is refused with the time") {
  sim::Surface s = sheet_of(8.0, 8.0);
  s.motion.velocity_mm_per_s = {300.0, 0.0, 0.0};
  sim::Scene scene = scene_of(s);
  test::check_error(sim::validate_travel(scene, 30.0), ErrorCode::out_of_range, "sheet",
                    {"1000000", "3333.333333", "duration_s"});
  scene.duration_s = 10.0;
  CHECK(sim::validate_travel(scene, 30.0).has_value());
}

TEST_CASE("every value of a scene has a range, and a sentence that names it") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  struct Case {
    void (*spoil)(sim::Scene&, double);
    double value;
    test::Named named;
    ErrorCode code = ErrorCode::out_of_range;
    const char* place = "some";
  };
  using S = sim::Scene;
  for (const Case& c : std::initializer_list<Case>{
           {[](S&s, double v) { s.light.level = v; }, -0.5, {"level", "-0.5", "1000"}},
           {[](S&s, double v) { s.light.level = v; }, nan, {"level", "nan"}},
           {[](S&s, double v) { s.light.falloff = v; }, 1.5, {"falloff", "1.5"}},
           {[](S&s, double v) { s.light.drift_per_hour = v; }, -1.5, {"drift_per_hour", "-1.5"}},
           {[](S&s, double v) { s.light.mains_hz = v; }, 20.0, {"mains_hz", "20", "40", "500"}},
           {[](S&s, double v) { s.light.flicker_depth = v; }, 0.5, {"flicker_depth", "mains_hz"}, ErrorCode::mismatch},
           {[](S&s, double v) {
              s.light.spectrum = {v, v, v};
            },
            0.0,
            {"spectrum", "0"}},
           {[](S&s, double v) { s.light.spectrum[1] = v; }, -1.0, {"spectrum", "-1"}},
           {[](S&s, double v) { s.display.gamma = v; }, 0.1, {"gamma", "0.1", "5"}},
           {[](S&s, double v) { s.display.black_level = v; }, 1.0, {"black_level", "1", "0.9"}},
           {[](S&s, double v) { s.display.refresh_hz = v; }, -60.0, {"refresh_hz", "-60"}},
           {[](S&s, double v) { s.display.pixel_blur = v; }, 1.1, {"pixel_blur", "1.1"}},
           {[](S&s, double v) { s.duration_s = v; }, -1.0, {"duration_s", "-1"}},
           {[](S&s, double v) { s.duration_s = v; }, inf, {"duration_s", "inf"}},
           {[](S&s, double v) { s.surfaces[0].pose.tilt_rad = v; },
            nan,
            {"tilt_rad", "nan"},
            ErrorCode::out_of_range,
            "sheet"},
           {[](S&s, double v) { s.surfaces[0].pose.centre_mm.y = v; },
            2e6,
            {"2000000", "1000000"},
            ErrorCode::out_of_range,
            "sheet"},
           {[](S&s, double v) { s.surfaces[0].motion.start_s = v; },
            -1.0,
            {"start_s", "-1"},
            ErrorCode::out_of_range,
            "sheet"},
           {[](S&s, double v) { s.surfaces[0].motion.velocity_mm_per_s.z = v; },
            nan,
            {"velocity_mm_per_s", "nan"},
            ErrorCode::out_of_range,
            "sheet"},
           {[](S&s, double v) { s.surfaces[0].motion.roll_rad_per_s = v; },
            inf,
            {"roll_rad_per_s", "inf"},
            ErrorCode::out_of_range,
            "sheet"},
           {[](S&s, double v) {
              s.surfaces[0].motion.path = {{0.0, {}}, {v, {}}};
            },
            0.0,
            {"path", "0"},
            ErrorCode::mismatch,
            "sheet"},
           {[](S&s, double v) {
              s.surfaces[0].motion.path = {{1.0, {v, 0.0, 0.0}}};
            },
            inf,
            {"path", "inf"},
            ErrorCode::out_of_range,
            "sheet"},
           {[](S&s, double) { s.surfaces[0].motion.repeats = true; },
            0.0,
            {"repeats", "path"},
            ErrorCode::mismatch,
            "sheet"},
           {[](S&s, double) { s.surfaces[0].shape = sim::Shape::relief; },
            0.0,
            {"relief", "heights"},
            ErrorCode::mismatch,
            "sheet"},
           {[](S&s, double v) { s.surfaces[0].shape = sim::Shape::sphere, s.surfaces[0].width_mm = v; },
            1.0,
            {"sphere", "height_mm", "width_mm"},
            ErrorCode::mismatch,
            "sheet"},
       }) {
    CAPTURE(c.named.front());
    CAPTURE(c.value);
    sim::Scene scene = scene_of(sheet_of(8.0, 8.0));
    REQUIRE(sim::validate(scene).has_value());
    c.spoil(scene, c.value);
    test::check_error(sim::validate(scene), c.code, c.place, c.named);
  }
}
