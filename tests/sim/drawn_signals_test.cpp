#include "sim/render/drawn_signals.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/nominal.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sim/render_rig.hpp"

using namespace compueye;
using hal::Lattice;
using sim::drawn_signals;
using sim::Scene;
using sim::scene_on;
using test::deg;
using test::RenderRig;

namespace {

constexpr Lattice lattices[] = {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane,
                                Lattice::cylinder};

/// Sections that are ellipses, parabolas and hyperbolas, some beyond the plane's edge.
RenderRig odd_eye(Lattice lattice, double acceptance_deg) {
  RenderRig rig = test::small_eye(acceptance_deg);
  rig.eye.lattice = lattice;
  rig.eye.rows = 5;
  rig.eye.columns = 7;
  rig.eye.interommatidial_rad = 16.0 * deg;
  rig.eye.pitch_mm = 1.1;
  rig.object = {10, 14, 30.0, 20.0, 6.0};
  return rig;
}

std::vector<double> signals_of(const RenderRig& rig, const Scene& scene) {
  return drawn_signals(rig.eye, rig.object, scene).value();
}

}  // namespace

// calib covers pixels by closed forms and shares no code with the renderer.
TEST_CASE("drawn signals of a picture of the plane's own pixels are the nominal response times the picture") {
  for (const Lattice lattice : lattices) {
    for (const double acceptance_deg : {3.0, 25.0, 60.0, 120.0}) {
      CAPTURE(hal::name(lattice));
      CAPTURE(acceptance_deg);
      const RenderRig rig = odd_eye(lattice, acceptance_deg);
      for (const char* name : {"phantom", "bars", "white"}) {
        const hal::Image picture = test::picture_of(name, rig.object, 8);
        const auto response = calib::nominal_response(rig.eye, rig.object).value();
        std::vector<double> expected(static_cast<std::size_t>(rig.eye.ommatidia()));
        response.forward(std::vector<double>(picture.pixels.begin(), picture.pixels.end()), expected);
        const std::vector<double> signals = signals_of(rig, scene_on(rig.object, name, picture));
        CHECK(test::largest_difference(signals, expected) < sim::drawn_signal_tolerance);
        CHECK(*std::max_element(signals.begin(), signals.end()) > 0.0);
      }
    }
  }
}

TEST_CASE("drawn signals of a sheet of its own size and pixels agree with point sampling of the cone") {
  for (const Lattice lattice : lattices) {
    CAPTURE(hal::name(lattice));
    const RenderRig rig = odd_eye(lattice, 25.0);
    Scene scene = scene_on(rig.object, "phantom", sim::render_built_in("phantom", 23, 9, 8).value());
    scene.surfaces[0].width_mm = 13.0;
    scene.surfaces[0].height_mm = 17.0;
    const std::vector<double> signals = signals_of(rig, scene);
    for (const auto& [i, k] : {std::pair{2, 3}, std::pair{1, 2}, std::pair{3, 5}}) {
      constexpr int n = 40;
      const double sampled = test::sampled_signal(rig, scene, i, k, n);
      CHECK(std::fabs(signals[static_cast<std::size_t>(i * 7 + k)] - sampled) < 0.02);
    }
  }
}

TEST_CASE("drawn signals know neither distance nor tilt, motion or lamp") {
  const RenderRig rig = test::small_eye(20.0);
  const Scene flat = scene_on(rig.object, "bars", test::picture_of("bars", rig.object));
  Scene scene = flat;
  scene.surfaces[0].distance_mm = 12.0;
  scene.surfaces[0].pose.tilt_rad = 30.0 * deg;
  scene.surfaces[0].motion.velocity_mm_per_s = {1.0, 2.0, 3.0};
  scene.light.level = 0.5;
  CHECK(signals_of(rig, scene) == signals_of(rig, flat));
}

TEST_CASE("an eye, a plane or a scene that cannot be is refused by name") {
  const RenderRig rig = test::small_eye();
  const Scene white = scene_on(rig.object, "white", hal::Image(1, 1, 1.0F));
  RenderRig bad = rig;
  bad.eye.rows = -3;
  CHECK_FALSE(drawn_signals(bad.eye, bad.object, white).has_value());
  bad = rig;
  bad.eye.acceptance_rad = std::nan("");
  test::check_error(drawn_signals(bad.eye, bad.object, white), hal::ErrorCode::out_of_range, "eye.acceptance_angle_deg",
                    {"nan"});
  bad = rig;
  bad.object.width_mm = -1.0;
  test::check_error(drawn_signals(bad.eye, bad.object, white), hal::ErrorCode::out_of_range, "object.width_mm", {"-1"});
  CHECK(drawn_signals(rig.eye, rig.object, Scene{}).error().code == hal::ErrorCode::usage);
}
