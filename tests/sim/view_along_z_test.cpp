#include "sim/scene/view_along_z.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <string>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/scene/scene_truth.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;

namespace {

using compueye::test::deg;

hal::ObjectPlane plane(int side, double side_mm) {
  hal::ObjectPlane object;
  object.rows = object.cols = side;
  object.width_mm = object.height_mm = side_mm;
  object.distance_mm = 30.0;
  return object;
}

sim::Surface& add(sim::Scene& scene, const char* name, double side_mm, float light) {
  sim::Surface& s = scene.surfaces.emplace_back();
  s.name = name;
  s.bands = {hal::Image(2, 2, light)};
  s.width_mm = s.height_mm = side_mm;
  return s;
}

double sum(const hal::Image& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
}

}  // namespace

TEST_CASE("seen along z a plain sheet is what the exact truth shows of it") {
  // The other way integrates areas and has no rays.
  const hal::ObjectPlane object = plane(32, 8.0);
  sim::Scene scene = sim::scene_on(object, "text", sim::render_built_in("text", 128, 128, 0).value());
  scene.surfaces[0].width_mm = scene.surfaces[0].height_mm = 6.0;
  const hal::Image exact = sim::scene_truth(scene, object).value();
  const hal::Image seen = sim::view_along_z(scene, object, 0.0);
  double squares = 0.0;
  for (std::size_t n = 0; n < seen.pixels.size(); ++n) {
    squares += std::pow(static_cast<double>(seen.pixels[n] - exact.pixels[n]), 2.0);
  }
  CHECK(std::sqrt(squares / static_cast<double>(seen.pixels.size())) < 0.03);
}

TEST_CASE("the area that is seen of a surface is as tall, tilted and round as geometry says") {
  const hal::ObjectPlane object = plane(200, 10.0);
  const double pixel_mm2 = std::pow(object.pixel_width_mm(), 2.0);
  const auto area = [&](void (*change)(sim::Surface&)) {
    sim::Scene scene;
    change(add(scene, "sheet", 4.0, 1.0F));
    return sum(sim::scene_truth(scene, object).value()) * pixel_mm2;
  };
  CHECK(area([](sim::Surface& s) { s.pose.tilt_rad = 60.0 * deg; }) == doctest::Approx(16.0 * 0.5).epsilon(0.01));
  CHECK(area([](sim::Surface& s) { s.pose.lean_rad = 30.0 * deg, s.pose.roll_rad = 1.0; }) ==
        doctest::Approx(16.0 * std::cos(30.0 * deg)).epsilon(0.01));
  CHECK(area([](sim::Surface& s) { s.shape = sim::Shape::sphere; }) ==
        doctest::Approx(std::acos(-1.0) * 4.0).epsilon(0.01));
  // Half of it beyond the edge.
  CHECK(area([](sim::Surface& s) { s.pose.centre_mm.x = 5.0; }) == doctest::Approx(8.0).epsilon(0.01));
  CHECK(area([](sim::Surface& s) { s.pose.tilt_rad = 90.0 * deg; }) == doctest::Approx(0.0));
}

TEST_CASE("right is right, up is up, and what is nearer hides what is behind") {
  const hal::ObjectPlane object = plane(10, 10.0);
  sim::Scene scene;
  add(scene, "far", 10.0, 0.25F).distance_mm = 40.0;
  sim::Surface& card = add(scene, "near", 2.0, 1.0F);
  card.distance_mm = 20.0;
  card.pose.centre_mm.x = 3.0;
  card.pose.centre_mm.y = 4.0;
  hal::Image seen = sim::scene_truth(scene, object).value();
  CHECK(seen.at(0, 8) == doctest::Approx(1.0));
  CHECK(seen.at(1, 7) == doctest::Approx(1.0));
  CHECK(seen.at(8, 8) == doctest::Approx(0.25));
  scene.surfaces[1].distance_mm = 50.0;
  CHECK(sim::scene_truth(scene, object)->at(0, 8) == doctest::Approx(0.25));
  scene.surfaces[1].distance_mm = 40.0;  // as far: the later one
  CHECK(sim::scene_truth(scene, object)->at(0, 8) == doctest::Approx(1.0));
  // A tilt to the right brings the left edge before a sheet that stands between.
  scene.surfaces[0].pose.tilt_rad = 60.0 * deg;
  scene.surfaces[1] = scene.surfaces[0];
  scene.surfaces[1].name = "between";
  scene.surfaces[1].pose.tilt_rad = 0.0;
  scene.surfaces[1].bands = {hal::Image(2, 2, 1.0F)};
  seen = sim::scene_truth(scene, object).value();
  CHECK(seen.at(5, 3) == doctest::Approx(0.25));
  CHECK(seen.at(5, 6) == doctest::Approx(1.0));
}

TEST_CASE("the truth follows light, bands and motion") {
  const hal::ObjectPlane object = plane(10, 10.0);
  sim::Scene scene;
  sim::Surface& card = add(scene, "card", 2.0, 0.5F);
  card.bands.resize(3, card.bands.front());
  card.bands[2] = hal::Image(2, 2, 2.0F);
  card.motion.velocity_mm_per_s = {2.0, 0.0, 0.0};
  scene.light.level = 3.0;
  const hal::Image before = sim::scene_truth(scene, object).value();
  CHECK(before.at(5, 5) == doctest::Approx(3.0));  // 3 (0.5 + 0.5 + 2) / 3
  CHECK(before.at(5, 7) == 0.0F);
  const hal::Image after = sim::scene_truth(scene, object, 1.0).value();
  CHECK(after.at(5, 7) == doctest::Approx(3.0));
  CHECK(after.at(5, 5) == 0.0F);
}
