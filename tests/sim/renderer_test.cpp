#include "sim/render/renderer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/pictures/built_in_scenes.hpp"

using namespace compueye;
using hal::Lattice;
using sim::OpticsAsBuilt;
using sim::Renderer;
using sim::RenderSettings;
using sim::Scene;
using sim::scene_on;

namespace {

constexpr double deg = std::numbers::pi / 180.0;

struct Setup {
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  RenderSettings settings;
};

Setup small_eye(double acceptance_deg = 8.0) {
  Setup setup;
  setup.eye.interommatidial_rad = 1.5 * deg;
  setup.eye.acceptance_rad = acceptance_deg * deg;
  setup.settings.true_depth = true;
  return setup;
}

// The field of 80x80 ommatidia 2.25 deg apart, with every fourth of them.
Setup wide_eye() {
  Setup setup = small_eye(60.0);
  setup.eye.rows = setup.eye.columns = 20;
  setup.eye.interommatidial_rad = 9.0 * deg;
  setup.object = {160, 160, 60.0, 60.0, 10.0};
  return setup;
}

std::vector<double> rendered(const Setup& setup, const Scene& scene, const OpticsAsBuilt& optics, double t_s = 0.0) {
  auto renderer = Renderer::create(setup.eye, setup.object, optics, setup.settings, scene);
  REQUIRE(renderer.has_value());
  std::vector<double> signals(optics.ommatidia.size());
  renderer->render(t_s, signals);
  return signals;
}

std::vector<double> rendered(const Setup& setup, const Scene& scene, double t_s = 0.0) {
  return rendered(setup, scene, OpticsAsBuilt::drawn(setup.eye), t_s);
}

hal::Image picture_of(const char* name, const hal::ObjectPlane& object, std::uint64_t seed = 0) {
  return sim::render_built_in(name, object.rows, object.cols, seed).value();
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t m = 0; m < a.size(); ++m) largest = std::max(largest, std::fabs(a[m] - b[m]));
  return largest;
}

// The cone itself, point by point: `n` x `n` points in every scene pixel, no conic and no chord.
double sampled_signal(const Setup& setup, const Scene& scene, int i, int k, int n) {
  const sim::Surface& sheet = scene.surfaces[0];
  const hal::Vec3 apex = setup.eye.apex(i, k), axis = setup.eye.axis(i, k);
  const double z = setup.object.z_mm(setup.eye) - apex.z;
  const double pitch_x = sheet.width_mm / sheet.picture().cols, pitch_y = sheet.height_mm / sheet.picture().rows;
  double sum = 0.0;
  for (int row = 0; row < sheet.picture().rows * n; ++row) {
    const double y = sheet.height_mm / 2.0 - (row + 0.5) * pitch_y / n - apex.y;
    for (int col = 0; col < sheet.picture().cols * n; ++col) {
      const double x = (col + 0.5) * pitch_x / n - sheet.width_mm / 2.0 - apex.x;
      const double angle = std::acos((x * axis.x + y * axis.y + z * axis.z) / std::sqrt(x * x + y * y + z * z));
      if (angle <= setup.eye.acceptance_rad / 2.0) sum += static_cast<double>(sheet.picture().at(row / n, col / n));
    }
  }
  return sum * pitch_x * pitch_y / (n * n) / (setup.object.pixel_width_mm() * setup.object.pixel_height_mm());
}

}  // namespace

TEST_CASE("signals agree with point sampling of the cone for every lattice and acceptance") {
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    for (const double acceptance_deg : {3.0, 25.0, 60.0, 120.0}) {
      CAPTURE(hal::name(lattice));
      CAPTURE(acceptance_deg);
      Setup setup = small_eye(acceptance_deg);
      setup.eye.lattice = lattice;
      setup.eye.rows = 5;
      setup.eye.columns = 7;
      setup.eye.interommatidial_rad = 16.0 * deg;
      setup.eye.pitch_mm = 1.1;
      setup.object = {10, 14, 30.0, 20.0, 6.0};
      const Scene scene = scene_on(setup.object, "phantom", picture_of("phantom", setup.object, 8));
      const std::vector<double> signals = rendered(setup, scene);
      for (const auto& [i, k] : {std::pair{2, 3}, std::pair{1, 2}, std::pair{0, 6}, std::pair{4, 1}}) {
        constexpr int n = 40;
        CHECK(std::fabs(signals[static_cast<std::size_t>(i * 7 + k)] - sampled_signal(setup, scene, i, k, n)) < 0.02);
      }
    }
  }
}

TEST_CASE("a white scene gives the area of the conic in pixels, whatever its own pixels") {
  Setup setup = small_eye();
  setup.object = {40, 40, 80.0, 80.0, 30.0};
  setup.eye.interommatidial_rad = 5.0 * deg;
  for (const int pixels : {1, 3, 500}) {
    CAPTURE(pixels);
    const std::vector<double> signals =
        rendered(setup, scene_on(setup.object, "white", hal::Image(pixels, pixels, 1.0F)));
    for (int i = 0; i < setup.eye.rows; ++i) {
      for (int k = 0; k < setup.eye.columns; ++k) {
        // An ellipse with half axes Z sin h cos h / (cos^2 t - sin^2 h) and Z sin h / sqrt(cos^2 t - sin^2 h).
        const double depth = setup.object.z_mm(setup.eye) - setup.eye.apex(i, k).z;
        const double h = setup.eye.acceptance_rad / 2.0, cos_t = setup.eye.axis(i, k).z;
        const double q = cos_t * cos_t - std::sin(h) * std::sin(h);
        const double area =
            std::numbers::pi * depth * depth * std::sin(h) * std::sin(h) * std::cos(h) / std::pow(q, 1.5) / 4.0;
        CHECK(std::fabs(signals[static_cast<std::size_t>(i * setup.eye.columns + k)] - area) <
              setup.settings.tolerance);
      }
    }
  }
}

TEST_CASE("a flat picture is integrated to the tolerance, measured against a thousandth of it") {
  for (Setup setup : {small_eye(), wide_eye()}) {
    for (const char* name : {"fig2", "line-art", "bars", "dots"}) {
      CAPTURE(name);
      hal::Image picture = picture_of(name, setup.object);
      for (float& pixel : picture.pixels) pixel = pixel > 0.5F ? 1.0F : 0.0F;
      const Scene scene = scene_on(setup.object, name, picture);
      const std::vector<double> usual = rendered(setup, scene);
      setup.settings.tolerance = 1e-6;
      const std::vector<double> reference = rendered(setup, scene);
      setup.settings.tolerance = 1e-3;
      CHECK(largest_difference(usual, reference) < 1e-3);
      CHECK(*std::max_element(reference.begin(), reference.end()) > 0.5);
    }
  }
}

TEST_CASE("the resolution of the picture does not matter, only what it shows") {
  const Setup setup = small_eye();
  const hal::Image coarse = picture_of("fig2", setup.object);
  const std::vector<double> signals = rendered(setup, scene_on(setup.object, "fig2", coarse));
  for (const int factor : {3, 40}) {
    hal::Image fine(16 * factor, 16 * factor);
    for (int r = 0; r < fine.rows; ++r) {
      for (int c = 0; c < fine.cols; ++c) fine.at(r, c) = coarse.at(r / factor, c / factor);
    }
    CHECK(largest_difference(signals, rendered(setup, scene_on(setup.object, "fig2", fine))) < 5e-4);
  }
}

TEST_CASE("light adds up") {
  const Setup setup = wide_eye();
  const hal::Image a = picture_of("line-art", setup.object, 1), b = picture_of("dots", setup.object, 2);
  hal::Image both = a;
  for (std::size_t n = 0; n < both.pixels.size(); ++n) both.pixels[n] = 0.5F * a.pixels[n] + 2.0F * b.pixels[n];
  std::vector<double> sum = rendered(setup, scene_on(setup.object, "a", a));
  const std::vector<double> other = rendered(setup, scene_on(setup.object, "b", b));
  for (std::size_t m = 0; m < sum.size(); ++m) sum[m] = 0.5 * sum[m] + 2.0 * other[m];
  CHECK(largest_difference(sum, rendered(setup, scene_on(setup.object, "both", both))) < 1e-4);
}

TEST_CASE("an ommatidium is the weighted sum of its cones, also of a negative one") {
  const Setup setup = small_eye();
  const Scene scene = scene_on(setup.object, "bars", picture_of("bars", setup.object));
  OpticsAsBuilt stacked = OpticsAsBuilt::drawn(setup.eye), wide = stacked, askew = stacked;
  for (std::size_t m = 0; m < stacked.ommatidia.size(); ++m) {
    sim::ConeOfLight cone = stacked.ommatidia[m].cones[0], other = cone;
    other.half_angle_rad = 2.0 * deg;
    other.axis = setup.eye.axis(0, static_cast<int>(m) % 8);
    stacked.ommatidia[m].cones = {{cone.axis, cone.half_angle_rad, 0.75}, {other.axis, other.half_angle_rad, -0.25}};
    askew.ommatidia[m].cones = {other};
  }
  std::vector<double> sum = rendered(setup, scene, wide);
  const std::vector<double> taken = rendered(setup, scene, askew);
  for (std::size_t m = 0; m < sum.size(); ++m) sum[m] = 0.75 * sum[m] - 0.25 * taken[m];
  CHECK(largest_difference(sum, rendered(setup, scene, stacked)) < 1e-10);
}

TEST_CASE("a scene at another distance is seen along the rays") {
  Setup setup = small_eye(40.0);
  setup.eye.rows = setup.eye.columns = 1;  // its apex is on the axis, so scaling about it keeps every ray
  Scene scene = scene_on(setup.object, "fig2", picture_of("fig2", setup.object));
  const double near = rendered(setup, scene)[0];
  scene.surfaces[0].width_mm *= 2.5;
  scene.surfaces[0].height_mm *= 2.5;
  scene.surfaces[0].distance_mm = 2.5 * setup.object.distance_mm;
  CHECK(rendered(setup, scene)[0] == doctest::Approx(near).epsilon(1e-5));

  setup = small_eye();
  Scene white = scene_on(setup.object, "white", hal::Image(2, 2, 1.0F));
  white.surfaces[0].width_mm = white.surfaces[0].height_mm = 200.0;
  const std::vector<double> at_plane = rendered(setup, white);
  white.surfaces[0].distance_mm = 11.0;
  CHECK(largest_difference(rendered(setup, white), at_plane) < 2.0 * setup.settings.tolerance);
  white.surfaces[0].pose.tilt_rad = 5.0 * deg;
  white.surfaces[0].distance_mm = 25.0;
  CHECK(largest_difference(rendered(setup, white), at_plane) < 2.0 * setup.settings.tolerance);
}

TEST_CASE("the top left of the picture is seen by the first ommatidia") {
  const Setup setup = small_eye(2.0);
  hal::Image picture(16, 16);
  picture.at(2, 5) = 1.0F;
  const std::vector<double> signals = rendered(setup, scene_on(setup.object, "point", picture));
  const auto brightest = std::max_element(signals.begin(), signals.end()) - signals.begin();
  CHECK(brightest / 8 < 4);
  CHECK(brightest % 8 < 4);
  CHECK(brightest / 8 < brightest % 8);
}

TEST_CASE("no light, no signal: black scenes, ommatidia that look past the plane, and a sheet's back") {
  const Setup setup = wide_eye();
  const std::vector<double> black = rendered(setup, scene_on(setup.object, "black", hal::Image(7, 7)));
  CHECK(black == std::vector<double>(400, 0.0));
  Scene scene = scene_on(setup.object, "white", hal::Image(7, 7, 1.0F));
  const std::vector<double> white = rendered(setup, scene);
  CHECK(white[0] == 0.0);
  CHECK(*std::max_element(white.begin(), white.end()) <= setup.object.pixels());
  scene.surfaces[0].pose.tilt_rad = std::numbers::pi;
  CHECK(rendered(setup, scene) == std::vector<double>(400, 0.0));
}
