#include "sim/render/renderer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/sim/render_rig.hpp"

using namespace compueye;
using hal::Lattice;
using sim::OpticsAsBuilt;
using sim::Scene;
using sim::scene_on;
using test::deg;
using test::largest_difference;
using test::picture_of;
using test::rendered;
using test::RenderRig;
using test::sampled_signal;
using test::small_eye;
using test::wide_eye;

TEST_CASE("signals agree with point sampling of the cone for every lattice and acceptance") {
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    for (const double acceptance_deg : {3.0, 25.0, 60.0, 120.0}) {
      CAPTURE(hal::name(lattice));
      CAPTURE(acceptance_deg);
      RenderRig rig = small_eye(acceptance_deg);
      rig.eye.lattice = lattice;
      rig.eye.rows = 5;
      rig.eye.columns = 7;
      rig.eye.interommatidial_rad = 16.0 * deg;
      rig.eye.pitch_mm = 1.1;
      rig.object = {10, 14, 30.0, 20.0, 6.0};
      const Scene scene = scene_on(rig.object, "phantom", picture_of("phantom", rig.object, 8));
      const std::vector<double> signals = rendered(rig, scene);
      for (const auto& [i, k] : {std::pair{2, 3}, std::pair{1, 2}, std::pair{0, 6}, std::pair{4, 1}}) {
        constexpr int n = 40;
        CHECK(std::fabs(signals[static_cast<std::size_t>(i * 7 + k)] - sampled_signal(rig, scene, i, k, n)) < 0.02);
      }
    }
  }
}

TEST_CASE("a white scene gives the area of the conic in pixels, whatever its own pixels") {
  RenderRig rig = small_eye();
  rig.object = {40, 40, 80.0, 80.0, 30.0};
  rig.eye.interommatidial_rad = 5.0 * deg;
  for (const int pixels : {1, 3, 500}) {
    CAPTURE(pixels);
    const std::vector<double> signals = rendered(rig, scene_on(rig.object, "white", hal::Image(pixels, pixels, 1.0F)));
    for (int i = 0; i < rig.eye.rows; ++i) {
      for (int k = 0; k < rig.eye.columns; ++k) {
        // An ellipse with half axes Z sin h cos h / (cos^2 t - sin^2 h) and Z sin h / sqrt(cos^2 t - sin^2 h).
        const double depth = rig.object.z_mm(rig.eye) - rig.eye.apex(i, k).z;
        const double h = rig.eye.acceptance_rad / 2.0, cos_t = rig.eye.axis(i, k).z;
        const double q = cos_t * cos_t - std::sin(h) * std::sin(h);
        const double area =
            std::numbers::pi * depth * depth * std::sin(h) * std::sin(h) * std::cos(h) / std::pow(q, 1.5) / 4.0;
        CHECK(std::fabs(signals[static_cast<std::size_t>(i * rig.eye.columns + k)] - area) < rig.settings.tolerance);
      }
    }
  }
}

TEST_CASE("a flat picture is integrated to the tolerance, measured against a thousandth of it") {
  for (RenderRig rig : {small_eye(), wide_eye()}) {
    for (const char* name : {"fig2", "line-art", "bars", "dots"}) {
      CAPTURE(name);
      hal::Image picture = picture_of(name, rig.object);
      for (float& pixel : picture.pixels) pixel = pixel > 0.5F ? 1.0F : 0.0F;
      const Scene scene = scene_on(rig.object, name, picture);
      const std::vector<double> usual = rendered(rig, scene);
      rig.settings.tolerance = 1e-6;
      const std::vector<double> reference = rendered(rig, scene);
      rig.settings.tolerance = 1e-3;
      CHECK(largest_difference(usual, reference) < 1e-3);
      CHECK(*std::max_element(reference.begin(), reference.end()) > 0.5);
    }
  }
}

TEST_CASE("the resolution of the picture does not matter, only what it shows") {
  const RenderRig rig = small_eye();
  const hal::Image coarse = picture_of("fig2", rig.object);
  const std::vector<double> signals = rendered(rig, scene_on(rig.object, "fig2", coarse));
  for (const int factor : {3, 40}) {
    hal::Image fine(16 * factor, 16 * factor);
    for (int r = 0; r < fine.rows; ++r) {
      for (int c = 0; c < fine.cols; ++c) fine.at(r, c) = coarse.at(r / factor, c / factor);
    }
    CHECK(largest_difference(signals, rendered(rig, scene_on(rig.object, "fig2", fine))) < 5e-4);
  }
}

TEST_CASE("light adds up") {
  const RenderRig rig = wide_eye();
  const hal::Image a = picture_of("line-art", rig.object, 1), b = picture_of("dots", rig.object, 2);
  hal::Image both = a;
  for (std::size_t n = 0; n < both.pixels.size(); ++n) both.pixels[n] = 0.5F * a.pixels[n] + 2.0F * b.pixels[n];
  std::vector<double> sum = rendered(rig, scene_on(rig.object, "a", a));
  const std::vector<double> other = rendered(rig, scene_on(rig.object, "b", b));
  for (std::size_t m = 0; m < sum.size(); ++m) sum[m] = 0.5 * sum[m] + 2.0 * other[m];
  CHECK(largest_difference(sum, rendered(rig, scene_on(rig.object, "both", both))) < 1e-4);
}

TEST_CASE("an ommatidium is the weighted sum of its cones, also of a negative one") {
  const RenderRig rig = small_eye();
  const Scene scene = scene_on(rig.object, "bars", picture_of("bars", rig.object));
  OpticsAsBuilt stacked = OpticsAsBuilt::drawn(rig.eye), wide = stacked, askew = stacked;
  for (std::size_t m = 0; m < stacked.ommatidia.size(); ++m) {
    sim::ConeOfLight cone = stacked.ommatidia[m].cones[0], other = cone;
    other.half_angle_rad = 2.0 * deg;
    other.axis = rig.eye.axis(0, static_cast<int>(m) % 8);
    stacked.ommatidia[m].cones = {{cone.axis, cone.half_angle_rad, 0.75}, {other.axis, other.half_angle_rad, -0.25}};
    askew.ommatidia[m].cones = {other};
  }
  std::vector<double> sum = rendered(rig, scene, wide);
  const std::vector<double> taken = rendered(rig, scene, askew);
  for (std::size_t m = 0; m < sum.size(); ++m) sum[m] = 0.75 * sum[m] - 0.25 * taken[m];
  CHECK(largest_difference(sum, rendered(rig, scene, stacked)) < 1e-10);
}

TEST_CASE("a scene at another distance is seen along the rays") {
  RenderRig rig = small_eye(40.0);
  rig.eye.rows = rig.eye.columns = 1;  // its apex is on the axis, so scaling about it keeps every ray
  Scene scene = scene_on(rig.object, "fig2", picture_of("fig2", rig.object));
  const double near = rendered(rig, scene)[0];
  scene.surfaces[0].width_mm *= 2.5;
  scene.surfaces[0].height_mm *= 2.5;
  scene.surfaces[0].distance_mm = 2.5 * rig.object.distance_mm;
  CHECK(rendered(rig, scene)[0] == doctest::Approx(near).epsilon(1e-5));

  rig = small_eye();
  Scene white = scene_on(rig.object, "white", hal::Image(2, 2, 1.0F));
  white.surfaces[0].width_mm = white.surfaces[0].height_mm = 200.0;
  const std::vector<double> at_plane = rendered(rig, white);
  white.surfaces[0].distance_mm = 11.0;
  CHECK(largest_difference(rendered(rig, white), at_plane) < 2.0 * rig.settings.tolerance);
  white.surfaces[0].pose.tilt_rad = 5.0 * deg;
  white.surfaces[0].distance_mm = 25.0;
  CHECK(largest_difference(rendered(rig, white), at_plane) < 2.0 * rig.settings.tolerance);
}

TEST_CASE("the top left of the picture is seen by the first ommatidia") {
  const RenderRig rig = small_eye(2.0);
  hal::Image picture(16, 16);
  picture.at(2, 5) = 1.0F;
  const std::vector<double> signals = rendered(rig, scene_on(rig.object, "point", picture));
  const auto brightest = std::max_element(signals.begin(), signals.end()) - signals.begin();
  CHECK(brightest / 8 < 4);
  CHECK(brightest % 8 < 4);
  CHECK(brightest / 8 < brightest % 8);
}

TEST_CASE("no light, no signal: black scenes, ommatidia that look past the plane, and a sheet's back") {
  const RenderRig rig = wide_eye();
  const std::vector<double> black = rendered(rig, scene_on(rig.object, "black", hal::Image(7, 7)));
  CHECK(black == std::vector<double>(400, 0.0));
  Scene scene = scene_on(rig.object, "white", hal::Image(7, 7, 1.0F));
  const std::vector<double> white = rendered(rig, scene);
  CHECK(white[0] == 0.0);
  CHECK(*std::max_element(white.begin(), white.end()) <= rig.object.pixels());
  scene.surfaces[0].pose.tilt_rad = std::numbers::pi;
  CHECK(rendered(rig, scene) == std::vector<double>(400, 0.0));
}
