// When the planner looks at what moves: whatever will be seen to move has moved at one of these times.

#include "sim/plan/times_to_look.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "sim/plan/preview.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::sim;
using test::deg;

namespace {

/// A card, white on its left half, on the object plane.
Scene half_card() {
  Scene scene = scene_on(hal::ObjectPlane{}, "card", hal::Image(1, 2));
  scene.surfaces[0].bands[0].pixels = {1.0F, 0.0F};
  scene.surfaces[0].width_mm = scene.surfaces[0].height_mm = 3.0;
  return scene;
}

struct Case {
  std::string name;
  std::function<void(Scene&)> moves;
};

EyeToSimulate small_eye() {
  EyeToSimulate board;
  board.eye.interommatidial_rad = 1.5 * deg;
  board.eye.acceptance_rad = 8.0 * deg;
  return board;
}

bool has_near(const std::vector<double>& times, double t_s) {
  return std::any_of(times.begin(), times.end(), [&](double t) { return std::fabs(t - t_s) < 1e-6; });
}

}  // namespace

TEST_CASE("motion that keeps a beat of seconds, passes once or comes and goes is seen to change something") {
  const Case cases[] = {
      {"a quarter a second", [](Scene& s) { s.surfaces[0].motion.roll_rad_per_s = 90.0 * deg; }},
      {"a round in 36 s", [](Scene& s) { s.surfaces[0].motion.roll_rad_per_s = -10.0 * deg; }},
      {"tilts a hundred times a second", [](Scene& s) { s.surfaces[0].motion.tilt_rad_per_s = 36000.0 * deg; }},
      {"there and back in 1.2 s",
       [](Scene& s) {
         s.surfaces[0].motion.path = {{0.0, {}}, {0.6, {2.0, 0.0, 0.0}}, {1.2, {0.0, 0.0, 0.0}}};
         s.surfaces[0].motion.repeats = true;
       }},
      {"through the field and back to its start in 3 s",
       [](Scene& s) {
         s.surfaces[0].pose.centre_mm.x = -20.0;
         s.surfaces[0].motion.path = {{0.0, {}}, {3.0, {40.0, 0.0, 0.0}}};
         s.surfaces[0].motion.repeats = true;
       }},
      {"passes once, after a second",
       [](Scene& s) {
         s.surfaces[0].pose.centre_mm.x = 100.0;
         s.surfaces[0].motion.velocity_mm_per_s.x = -100.0;
       }},
      {"begins late and passes once",
       [](Scene& s) {
         s.surfaces[0].pose.centre_mm.y = 50.0;
         s.surfaces[0].motion.start_s = 7.0;
         s.surfaces[0].motion.velocity_mm_per_s.y = -25.0;
       }},
      {"jumps in for a second",
       [](Scene& s) {
         s.surfaces[0].pose.centre_mm.x = 50.0;
         s.surfaces[0].motion.path = {{0.0, {}},
                                      {10.0, {0.0, 0.0, 0.0}},
                                      {10.0 + 1e-9, {-50.0, 0.0, 0.0}},
                                      {11.0, {-50.0, 0.0, 0.0}},
                                      {11.0 + 1e-9, {0.0, 0.0, 0.0}}};
       }},
  };
  const EyeToSimulate board = small_eye();
  for (const Case& each : cases) {
    CAPTURE(each.name);
    Scene scene = half_card();
    each.moves(scene);
    const auto preview = preview_of(board, scene);
    REQUIRE_MESSAGE(preview, (preview ? "" : preview.error().text()));
    REQUIRE(preview->standstill_change);
    CHECK(preview->rms > 50.0);  // LSB: though nothing may be in view at its start
    CHECK(*preview->standstill_change > 0.3 * preview->rms);
  }
}

TEST_CASE("what comes before another surface for a moment is seen to hide it") {
  Scene scene = half_card();
  scene.surfaces[0].bands = {hal::Image(1, 1, 1.0F)};
  Surface dark = scene.surfaces[0];
  dark.shape = Shape::sphere;
  dark.bands = {hal::Image(1, 1, 0.1F)};
  dark.distance_mm = 5.0;
  dark.pose.centre_mm.x = 100.0;
  dark.motion.velocity_mm_per_s.x = -100.0;
  scene.surfaces.push_back(dark);
  const auto preview = preview_of(small_eye(), scene);
  REQUIRE_MESSAGE(preview, (preview ? "" : preview.error().text()));
  REQUIRE(preview->shine_through_change);
  CHECK(*preview->shine_through_change > 0.3 * preview->rms);
}

TEST_CASE("times to look begin with the scene, ascend, stay within it and are few") {
  Scene scene = half_card();
  CHECK(times_to_look(scene) == std::vector{0.0});
  scene.duration_s = 4.0;
  for (int k = 0; k < 100; ++k) {
    Surface surface = scene.surfaces[0];
    surface.motion.start_s = 0.01 * k;
    surface.motion.roll_rad_per_s = 30.0 * (1 + k) * deg;
    surface.motion.velocity_mm_per_s = {1.0 * k, -2.0, 0.0};
    scene.surfaces.push_back(surface);
  }
  const std::vector<double> times = times_to_look(scene);
  CHECK(times.front() == 0.0);
  CHECK(times.back() <= 4.0);
  CHECK(std::is_sorted(times.begin(), times.end()));
  CHECK(std::adjacent_find(times.begin(), times.end()) == times.end());
  CHECK(times.size() > 5);
  CHECK(times.size() <= 1 + 4 + 16 * 4);
  scene.surfaces.resize(1);
  scene.surfaces[0].pose.centre_mm = {-3.0, 1.0, 0.0};
  scene.surfaces[0].motion.velocity_mm_per_s = {2.0, 0.0, 0.0};
  CHECK(has_near(times_to_look(scene), 1.5));
}
