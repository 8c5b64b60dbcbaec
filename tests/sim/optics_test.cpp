#include "sim/optics.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/pictures/built_in_scenes.hpp"

using namespace compueye;
using hal::Lattice;
using sim::AngularProfile;
using sim::Optics;
using sim::Scene;
using sim::scene_on;

namespace {

constexpr double deg = std::numbers::pi / 180.0;

Optics small_eye(double acceptance_deg = 8.0) {
  Optics optics;
  optics.eye.interommatidial_rad = 1.5 * deg;
  optics.eye.acceptance_rad = acceptance_deg * deg;
  optics.profile = AngularProfile::flat_top(optics.eye.acceptance_rad);
  return optics;
}

// The field of 80x80 ommatidia 2.25 deg apart, with every fourth of them.
Optics wide_eye() {
  Optics optics;
  optics.eye.rows = optics.eye.columns = 20;
  optics.eye.interommatidial_rad = 9.0 * deg;
  optics.eye.acceptance_rad = 60.0 * deg;
  optics.object = {160, 160, 60.0, 60.0, 10.0};
  optics.profile = AngularProfile::flat_top(optics.eye.acceptance_rad);
  return optics;
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
double sampled_signal(const Optics& optics, const Scene& scene, int i, int k, int n) {
  const sim::Surface& sheet = scene.surfaces[0];
  const hal::Vec3 apex = optics.eye.apex(i, k), axis = optics.eye.axis(i, k);
  const double z = optics.object.z_mm(optics.eye) - apex.z;
  const double pitch_x = sheet.width_mm / sheet.picture().cols, pitch_y = sheet.height_mm / sheet.picture().rows;
  double sum = 0.0;
  for (int row = 0; row < sheet.picture().rows * n; ++row) {
    const double y = sheet.height_mm / 2.0 - (row + 0.5) * pitch_y / n - apex.y;
    for (int col = 0; col < sheet.picture().cols * n; ++col) {
      const double x = (col + 0.5) * pitch_x / n - sheet.width_mm / 2.0 - apex.x;
      const double angle = std::acos((x * axis.x + y * axis.y + z * axis.z) / std::sqrt(x * x + y * y + z * z));
      if (angle <= optics.eye.acceptance_rad / 2.0) sum += static_cast<double>(sheet.picture().at(row / n, col / n));
    }
  }
  return sum * pitch_x * pitch_y / (n * n) / (optics.object.pixel_width_mm() * optics.object.pixel_height_mm());
}

}  // namespace

TEST_CASE("signals agree with point sampling of the cone for every lattice and acceptance") {
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    for (const double acceptance_deg : {3.0, 25.0, 60.0, 120.0}) {
      CAPTURE(hal::name(lattice));
      CAPTURE(acceptance_deg);
      Optics optics;
      optics.eye.lattice = lattice;
      optics.eye.rows = 5;
      optics.eye.columns = 7;
      optics.eye.interommatidial_rad = 16.0 * deg;
      optics.eye.acceptance_rad = acceptance_deg * deg;
      optics.eye.pitch_mm = 1.1;
      optics.object = {10, 14, 30.0, 20.0, 6.0};
      optics.profile = AngularProfile::flat_top(optics.eye.acceptance_rad);
      const Scene scene = scene_on(optics.object, "phantom", picture_of("phantom", optics.object, 8));
      const std::vector<double> signals = optics.expose(scene).value();
      for (const auto& [i, k] : {std::pair{2, 3}, std::pair{1, 2}, std::pair{0, 6}, std::pair{4, 1}}) {
        constexpr int n = 40;
        CHECK(std::fabs(signals[static_cast<std::size_t>(i * 7 + k)] - sampled_signal(optics, scene, i, k, n)) < 0.02);
      }
    }
  }
}

TEST_CASE("a white scene gives the area of the conic in pixels") {
  Optics optics = small_eye();
  optics.object = {40, 40, 80.0, 80.0, 30.0};
  optics.eye.interommatidial_rad = 5.0 * deg;
  const std::vector<double> signals = optics.expose(scene_on(optics.object, "white", hal::Image(3, 3, 1.0F))).value();
  for (int i = 0; i < optics.eye.rows; ++i) {
    for (int k = 0; k < optics.eye.columns; ++k) {
      // An ellipse with half axes Z sin h cos h / (cos^2 t - sin^2 h) and Z sin h / sqrt(cos^2 t - sin^2 h).
      const double depth = optics.object.z_mm(optics.eye) - optics.eye.apex(i, k).z;
      const double h = optics.eye.acceptance_rad / 2.0, cos_t = optics.eye.axis(i, k).z;
      const double q = cos_t * cos_t - std::sin(h) * std::sin(h);
      const double area = std::numbers::pi * depth * depth * std::sin(h) * std::sin(h) * std::cos(h) / std::pow(q, 1.5);
      CHECK(signals[static_cast<std::size_t>(i * optics.eye.columns + k)] == doctest::Approx(area / 4.0).epsilon(1e-5));
    }
  }
}

TEST_CASE("the default sampling is fine enough on both eyes") {
  for (Optics optics : {small_eye(), wide_eye()}) {
    const bool wide = optics.object.rows == 160;
    for (const char* name : {"fig2", "line-art", "bars", "dots"}) {
      CAPTURE(name);
      hal::Image picture = picture_of(name, optics.object);
      for (float& pixel : picture.pixels) pixel = pixel > 0.5F ? 1.0F : 0.0F;
      const Scene scene = scene_on(optics.object, name, picture);
      const std::vector<double> usual = optics.expose(scene).value();
      Optics finer = optics;
      finer.cells_per_pixel = 10 * optics.cells_per_pixel;
      const std::vector<double> reference = finer.expose(scene).value();
      const double brightest = *std::max_element(reference.begin(), reference.end());
      CHECK(largest_difference(usual, reference) < (wide ? 0.005 : 1e-4 * std::max(brightest, 1.0)));
      CHECK(brightest > 0.5);
    }
  }
}

TEST_CASE("the resolution of the picture does not matter, only what it shows") {
  const Optics optics = small_eye();
  const hal::Image coarse = picture_of("fig2", optics.object);
  const std::vector<double> signals = optics.expose(scene_on(optics.object, "fig2", coarse)).value();
  for (const int factor : {3, 40}) {
    hal::Image fine(16 * factor, 16 * factor);
    for (int r = 0; r < fine.rows; ++r) {
      for (int c = 0; c < fine.cols; ++c) fine.at(r, c) = coarse.at(r / factor, c / factor);
    }
    CHECK(largest_difference(signals, optics.expose(scene_on(optics.object, "fig2", fine)).value()) < 5e-4);
  }
}

TEST_CASE("light adds up") {
  const Optics optics = wide_eye();
  const hal::Image a = picture_of("line-art", optics.object, 1), b = picture_of("dots", optics.object, 2);
  hal::Image both = a;
  for (std::size_t n = 0; n < both.pixels.size(); ++n) both.pixels[n] = 0.5F * a.pixels[n] + 2.0F * b.pixels[n];
  const auto expose = [&](const hal::Image& image) {
    return optics.expose(scene_on(optics.object, "sum", image)).value();
  };
  std::vector<double> sum = expose(a);
  const std::vector<double> other = expose(b);
  for (std::size_t m = 0; m < sum.size(); ++m) sum[m] = 0.5 * sum[m] + 2.0 * other[m];
  CHECK(largest_difference(sum, expose(both)) < 1e-4);
}

TEST_CASE("an angular profile is the weighted sum of its cones") {
  Optics optics = small_eye();
  const Scene scene = scene_on(optics.object, "bars", picture_of("bars", optics.object));
  optics.profile.shells = {{4.0 * deg, 0.25}, {2.0 * deg, 0.75}};
  const std::vector<double> stacked = optics.expose(scene).value();
  std::vector<double> sum(stacked.size(), 0.0);
  for (const auto& [half_angle_deg, weight] : {std::pair{4.0, 0.25}, std::pair{2.0, 0.75}}) {
    const std::vector<double> one = small_eye(2.0 * half_angle_deg).expose(scene).value();
    for (std::size_t m = 0; m < sum.size(); ++m) sum[m] += weight * one[m];
  }
  CHECK(largest_difference(sum, stacked) < 1e-10);
}

TEST_CASE("a scene at another distance is seen along the rays") {
  Optics optics = small_eye(40.0);
  optics.eye.rows = optics.eye.columns = 1;  // its apex is on the axis, so scaling about it keeps every ray
  Scene scene = scene_on(optics.object, "fig2", picture_of("fig2", optics.object));
  const double near = optics.expose(scene).value()[0];
  scene.surfaces[0].width_mm *= 2.5;
  scene.surfaces[0].height_mm *= 2.5;
  scene.surfaces[0].distance_mm = 2.5 * optics.object.distance_mm;
  CHECK(optics.expose(scene).value()[0] == doctest::Approx(near).epsilon(1e-4));

  optics = small_eye();
  Scene white = scene_on(optics.object, "white", hal::Image(2, 2, 1.0F));
  white.surfaces[0].width_mm = white.surfaces[0].height_mm = 200.0;
  const std::vector<double> at_plane = optics.expose(white).value();
  white.surfaces[0].distance_mm = 11.0;
  CHECK(largest_difference(optics.expose(white).value(), at_plane) < 1e-3 * at_plane[0]);
}

TEST_CASE("the top left of the picture is seen by the first ommatidia") {
  Optics optics = small_eye(2.0);
  hal::Image picture(16, 16);
  picture.at(2, 5) = 1.0F;
  const std::vector<double> signals = optics.expose(scene_on(optics.object, "point", picture)).value();
  const auto brightest = std::max_element(signals.begin(), signals.end()) - signals.begin();
  CHECK(brightest / 8 < 4);
  CHECK(brightest % 8 < 4);
  CHECK(brightest / 8 < brightest % 8);
}

TEST_CASE("no light, no signal: black scenes and ommatidia that look past the plane") {
  const Optics optics = wide_eye();
  const std::vector<double> black = optics.expose(scene_on(optics.object, "black", hal::Image(7, 7))).value();
  CHECK(black == std::vector<double>(400, 0.0));
  const std::vector<double> white = optics.expose(scene_on(optics.object, "white", hal::Image(7, 7, 1.0F))).value();
  CHECK(white[0] == 0.0);
  CHECK(*std::max_element(white.begin(), white.end()) <= optics.object.pixels());
}

TEST_CASE("optics out of range are refused by name") {
  const Scene scene = scene_on(hal::ObjectPlane{}, "white", hal::Image(1, 1, 1.0F));
  const auto place = [&](const Optics& optics) {
    const auto result = optics.expose(scene);
    REQUIRE_FALSE(result.has_value());
    CHECK(result.error().code == hal::ErrorCode::out_of_range);
    return result.error().place;
  };
  Optics optics = small_eye();
  optics.cells_per_pixel = 0;
  CHECK(place(optics) == "optics.cells_per_pixel");
  optics = small_eye();
  optics.profile.shells.clear();
  CHECK(place(optics) == "angular profile");
  optics.profile.shells = {{61.0 * deg, 1.0}};
  CHECK(place(optics) == "angular profile");
  optics.profile.shells = {{1.0 * deg, std::nan("")}};
  CHECK(place(optics) == "angular profile");
  optics = small_eye();
  optics.object.width_mm = -1.0;
  CHECK(place(optics) == "object.width_mm");
  optics = small_eye();
  optics.eye.acceptance_rad = std::nan("");
  CHECK(place(optics) == "eye.acceptance_angle_deg");
}
