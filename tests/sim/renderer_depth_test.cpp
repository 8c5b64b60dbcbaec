// Surfaces at their true place: tilts, shadows and balls, against rays traced one by one (traced_rays.hpp), against a
// tolerance a thousand times finer, and against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/random/random.hpp"
#include "sim/render/renderer.hpp"
#include "tests/sanitized.hpp"
#include "tests/sim/render_rig.hpp"
#include "tests/sim/traced_rays.hpp"

using namespace compueye;
using sim::OpticsAsBuilt;
using sim::RenderSettings;
using sim::Scene;
using sim::Shape;
using sim::Surface;
using test::deg;
using test::largest_difference;
using test::RenderRig;

namespace {

RenderRig eye_of(double acceptance_deg) {
  RenderRig rig = test::small_eye(acceptance_deg);
  rig.eye.rows = rig.eye.columns = 3;
  rig.eye.interommatidial_rad = 22.0 * deg;
  rig.object = {160, 160, 60.0, 60.0, 10.0};
  return rig;
}

hal::Image random_picture(int rows, int cols, std::uint64_t seed) {
  sim::RandomStream random({seed, sim::Draws::picture, 0, 7});
  hal::Image picture(rows, cols);
  for (float& pixel : picture.pixels) pixel = random.uniform(0, 1) < 0.5 ? 0.0F : 1.0F;
  return picture;
}

Surface sheet(int pixels, double size_mm, double distance_mm, std::uint64_t seed) {
  Surface surface;
  surface.name = "sheet " + std::to_string(seed);
  surface.bands = {random_picture(pixels, pixels, seed)};
  surface.width_mm = surface.height_mm = size_mm;
  surface.distance_mm = distance_mm;
  return surface;
}

RenderSettings at_depth(bool occlusion, double tolerance = 3e-3) {
  RenderSettings settings;
  settings.true_depth = true;
  settings.occlusion = occlusion;
  settings.tolerance = tolerance;
  return settings;
}

std::vector<double> rendered(RenderRig rig, const Scene& scene, const RenderSettings& settings,
                             double obliquity = 0.0) {
  rig.settings = settings;
  OpticsAsBuilt optics = OpticsAsBuilt::drawn(rig.eye);
  optics.obliquity = obliquity;
  return test::rendered(rig, scene, optics);
}

/// Largest difference from traced rays as a share of the brightest signal.
double off_traced(const RenderRig& rig, const Scene& scene, const std::vector<double>& signals, bool occlusion,
                  double obliquity = 0.0, int rays_across = 700) {
  const OpticsAsBuilt optics = OpticsAsBuilt::drawn(rig.eye);
  const test::TracedRays rays(rig.eye, rig.object, scene, occlusion, test::sanitized ? 200 : rays_across);
  double largest = 0.0;
  for (std::size_t m = 0; m < signals.size(); ++m) {
    largest = std::max(largest, std::fabs(signals[m] - rays.signal(optics.ommatidia[m], obliquity)));
  }
  return largest / *std::max_element(signals.begin(), signals.end());
}

constexpr double traced_share = test::sanitized ? 1e-2 : 2e-3;

}  // namespace

TEST_CASE("tilted, leant and rolled planes agree with traced rays, and with a thousandth of the tolerance") {
  for (const double acceptance_deg : {4.0, 60.0}) {
    for (const int pixels : {5, 200}) {
      for (const double tilt_deg : {0.0, 30.0, 70.0}) {
        CAPTURE(acceptance_deg);
        CAPTURE(pixels);
        CAPTURE(tilt_deg);
        const RenderRig rig = eye_of(acceptance_deg);
        Scene scene;
        scene.surfaces.push_back(sheet(pixels, 30.0, 20.0, 3));
        scene.surfaces[0].pose.tilt_rad = tilt_deg * deg;
        scene.surfaces[0].pose.lean_rad = -0.3 * tilt_deg * deg;
        scene.surfaces[0].pose.roll_rad = 20.0 * deg;
        scene.surfaces[0].pose.centre_mm = {2.0, -1.0, 0.0};
        const std::vector<double> signals = rendered(rig, scene, at_depth(false));
        CHECK(off_traced(rig, scene, signals, false) < traced_share);
        if (test::sanitized) continue;
        CHECK(largest_difference(signals, rendered(rig, scene, at_depth(false, 3e-6))) < 3e-3);
      }
    }
  }
}
TEST_CASE("what is nearer along a ray hides what is behind, also where planes cut through each other") {
  const RenderRig rig = eye_of(60.0);
  Scene scene;
  scene.surfaces.push_back(sheet(100, 60.0, 20.0, 1));
  scene.surfaces.push_back(sheet(7, 9.0, 14.0, 2));
  scene.surfaces.push_back(sheet(11, 12.0, 12.0, 3));
  scene.surfaces[0].pose.tilt_rad = 15.0 * deg;
  scene.surfaces[1].pose.centre_mm = {2.0, 1.0, 0.0};
  scene.surfaces[1].pose.tilt_rad = 40.0 * deg;
  scene.surfaces[2].pose.centre_mm = {3.0, -3.0, 0.0};
  scene.surfaces[2].pose.tilt_rad = -40.0 * deg;
  scene.surfaces[2].pose.roll_rad = 30.0 * deg;
  const std::vector<double> signals = rendered(rig, scene, at_depth(true));
  CHECK(off_traced(rig, scene, signals, true) < traced_share);
  if (!test::sanitized) CHECK(largest_difference(signals, rendered(rig, scene, at_depth(true, 3e-6))) < 3e-3);
  const std::vector<double> added = rendered(rig, scene, at_depth(false));
  CHECK(off_traced(rig, scene, added, false) < traced_share);
  CHECK(largest_difference(signals, added) > 1.0);
}

TEST_CASE("balls agree with traced rays, hide and are hidden") {
  const RenderRig rig = eye_of(50.0);
  Scene scene;
  scene.surfaces.push_back(sheet(40, 60.0, 25.0, 1));
  scene.surfaces.push_back(sheet(9, 9.0, 12.0, 2));
  scene.surfaces[1].shape = Shape::sphere;
  scene.surfaces[1].pose.centre_mm = {2.0, 1.0, 0.0};
  scene.surfaces[1].pose.roll_rad = 20.0 * deg;
  scene.surfaces.push_back(sheet(3, 4.0, 6.0, 5));
  scene.surfaces[2].pose.centre_mm = {1.0, 2.0, 0.0};
  const std::vector<double> signals = rendered(rig, scene, at_depth(true));
  CHECK(off_traced(rig, scene, signals, true) < traced_share);
  if (!test::sanitized) CHECK(largest_difference(signals, rendered(rig, scene, at_depth(true, 3e-5))) < 3e-3);
}

// Much of each ball's rim is in sight, and tiles of one value meet edges of all kinds.
TEST_CASE("even balls seen from aside agree with traced rays, and with a hundredth of the tolerance") {
  const RenderRig rig = eye_of(50.0);
  for (const bool half_black : {false, true}) {
    CAPTURE(half_black);
    Scene scene;
    scene.surfaces.push_back(sheet(64, 60.0, 25.0, 1));
    scene.surfaces[0].bands = {hal::Image(64, 64, 0.5F)};
    scene.surfaces[0].pose.tilt_rad = 20.0 * deg;
    scene.surfaces.push_back(sheet(96, 9.0, 10.0, 2));
    Surface& ball = scene.surfaces[1];
    ball.shape = Shape::sphere;
    ball.bands = {hal::Image(96, 96, 1.0F)};
    for (int row = 0; half_black && row < 96; ++row) {
      for (int col = 0; col < 37; ++col) ball.bands[0].at(row, col) = 0.0F;
    }
    ball.pose.centre_mm = {3.0, 1.0, 0.0};
    ball.pose.tilt_rad = 25.0 * deg;
    scene.surfaces.push_back(sheet(3, 4.0, 4.0, 5));
    scene.surfaces[2].pose.centre_mm = {1.0, 2.0, 0.0};
    const std::vector<double> signals = rendered(rig, scene, at_depth(true), 0.5);
    CHECK(off_traced(rig, scene, signals, true, 0.5) < traced_share);
    if (test::sanitized) continue;
    CHECK(largest_difference(signals, rendered(rig, scene, at_depth(true, 3e-5), 0.5)) < 3e-3);
  }
}

// Seen from straight ahead its outline is a circle on the object plane, of which no pixel is hidden.
TEST_CASE("a white ball straight ahead shines as its outline on the object plane does") {
  RenderRig rig = eye_of(50.0);
  rig.eye.rows = rig.eye.columns = 1;
  Scene scene;
  scene.surfaces.push_back(sheet(1, 9.0, 14.0, 1));
  scene.surfaces[0].shape = Shape::sphere;
  scene.surfaces[0].bands = {hal::Image(1, 1, 1.0F)};
  const double apex = rig.eye.apex(0, 0).z, plane = rig.object.z_mm(rig.eye) - apex;
  const double distance = rig.eye.radius_mm + rig.eye.lens_height_mm + 14.0 - apex;
  const double radius = plane * std::tan(std::asin(4.5 / distance));
  const double expected =
      std::numbers::pi * radius * radius / (rig.object.pixel_width_mm() * rig.object.pixel_height_mm());
  for (const int pixels : {1, 7, 64, 100}) {
    CAPTURE(pixels);
    scene.surfaces[0].bands = {hal::Image(pixels, pixels, 1.0F)};
    CHECK(std::fabs(rendered(rig, scene, at_depth(false))[0] - expected) < 3e-3);
    CHECK(std::fabs(rendered(rig, scene, at_depth(false, 3e-5))[0] - expected) < 3e-5);
  }
}

TEST_CASE("rays count less by the power of the cosine of their angle") {
  const RenderRig rig = eye_of(60.0);
  for (const double tilt_deg : {0.0, 40.0}) {
    CAPTURE(tilt_deg);
    Scene scene;
    scene.surfaces.push_back(sheet(60, 40.0, 15.0, 4));
    scene.surfaces[0].pose.tilt_rad = tilt_deg * deg;
    const std::vector<double> signals = rendered(rig, scene, at_depth(false), 3.0);
    CHECK(off_traced(rig, scene, signals, false, 3.0) < traced_share);
    if (!test::sanitized) CHECK(largest_difference(signals, rendered(rig, scene, at_depth(false, 3e-6), 3.0)) < 3e-3);
  }
}

// The picture's pixels are half as wide as the heights', so that both take the relief as the same bilinear patches.
TEST_CASE("reliefs agree with traced rays, also where they hide a part of themselves") {
  const RenderRig rig = eye_of(50.0);
  for (const double highest_mm : {0.5, 4.0}) {
    if (test::sanitized && highest_mm < 1.0) continue;
    CAPTURE(highest_mm);
    Scene scene;
    scene.surfaces.push_back(sheet(16, 20.0, 14.0, 6));
    Surface& relief = scene.surfaces[0];
    relief.shape = Shape::relief;
    relief.heights = random_picture(8, 8, 9);
    for (float& height : relief.heights.pixels) height *= static_cast<float>(highest_mm);
    relief.pose.centre_mm = {1.0, 0.5, 0.0};
    relief.pose.tilt_rad = 10.0 * deg;
    const std::vector<double> signals = rendered(rig, scene, at_depth(true));
    CHECK(off_traced(rig, scene, signals, true, 0.0, test::sanitized ? 40 : 150) < 2.0 * traced_share);
    const double unhidden = largest_difference(signals, rendered(rig, scene, at_depth(false)));
    CHECK((unhidden > 0.1) == (highest_mm > 1.0));
    if (!test::sanitized) CHECK(largest_difference(signals, rendered(rig, scene, at_depth(true, 3e-4))) < 6e-3);
    relief.heights = hal::Image(1, 1, 2.0F);
    relief.pose.tilt_rad = 0.0;
    const std::vector<double> level = rendered(rig, scene, at_depth(true));
    relief.shape = Shape::plane;
    relief.heights = {};
    relief.distance_mm = 12.0;
    CHECK(largest_difference(level, rendered(rig, scene, at_depth(true))) < 6e-3);
  }
}
