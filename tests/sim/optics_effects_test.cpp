#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/hal/units.hpp"
#include "tests/sanitized.hpp"
#include "tests/sim/plane_levels.hpp"

using namespace compueye;
using test::Brightness;
using test::EffectRig;

namespace {

using compueye::test::deg;

double angle(const hal::Vec3& a, const hal::Vec3& b) {
  const hal::Vec3 across{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  return std::atan2(std::sqrt(across.x * across.x + across.y * across.y + across.z * across.z),
                    a.x * b.x + a.y * b.y + a.z * b.z);
}

/// The effect's bound on every tried picture against what it changes, counted cell by cell.
void check_bounds(EffectRig& rig, std::string_view name, double loosest = 10.0) {
  const sim::OpticsAsBuilt drawn = sim::OpticsAsBuilt::drawn(rig.board.eye);
  std::vector<Brightness> pictures = test::tried_pictures(rig.board.object);
  if (test::sanitized) pictures.resize(1);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    test::look_at(rig, pictures[k]);
    REQUIRE_FALSE(rig.called(name).empty());
    const auto changed = test::plane_levels(rig.workings({name}).optics, rig, pictures[k]);
    const double truth = test::rms_difference(changed, rig.preview.levels);
    CAPTURE(name);
    CAPTURE(k);
    CAPTURE(truth);
    CAPTURE(rig.preview.rms);
    CHECK(rig.bound(name) >= truth);
    CHECK(rig.bound(name) <= loosest * truth);
  }
}

}  // namespace

TEST_CASE("axes and apexes are off by the told rms, the same whatever noise is drawn") {
  EffectRig rig(40, 40);
  CHECK(rig.called("misalignment").empty());
  rig.board.build.pose_rms_deg = 0.5;
  rig.board.build.apex_rms_mm = 0.02;
  const sim::OpticsAsBuilt built = rig.workings({"misalignment"}).optics;
  const sim::OpticsAsBuilt drawn = sim::OpticsAsBuilt::drawn(rig.board.eye);
  double turns = 0.0, steps = 0.0;
  for (std::size_t m = 0; m < 1600; ++m) {
    const hal::Vec3 &a = built.ommatidia[m].apex_mm, &b = drawn.ommatidia[m].apex_mm;
    turns += std::pow(angle(built.ommatidia[m].cones[0].axis, drawn.ommatidia[m].cones[0].axis) / deg, 2) / 1600.0;
    steps += (std::pow(a.x - b.x, 2) + std::pow(a.y - b.y, 2) + std::pow(a.z - b.z, 2)) / 1600.0;
  }
  // Two and three normal numbers: chi squared.
  CHECK(std::fabs(turns / (2.0 * 0.25) - 1.0) < 4.0 / std::sqrt(1600.0));
  CHECK(std::fabs(steps / (3.0 * 0.0004) - 1.0) < 4.0 * std::sqrt(2.0 / 4800.0));
  const sim::OpticsAsBuilt again = rig.workings({"misalignment"}, 77).optics;
  CHECK(again.ommatidia[7].cones[0].axis.x == built.ommatidia[7].cones[0].axis.x);
}

TEST_CASE("bounds of pose and apex hold and are not loose") {
  for (const double pose : {0.1, 0.5, 2.0}) {
    EffectRig rig;
    rig.board.build.pose_rms_deg = pose;
    check_bounds(rig, "misalignment");
  }
  EffectRig rig;
  rig.board.build.apex_rms_mm = 0.1;
  check_bounds(rig, "misalignment");
}

TEST_CASE("acceptance angles spread as told and the bound holds") {
  EffectRig rig(40, 40);
  CHECK(rig.called("acceptance_spread").empty());
  rig.board.build.acceptance_spread = 0.05;
  const sim::OpticsAsBuilt built = rig.workings({"acceptance_spread"}).optics;
  std::vector<double> shares;
  for (const auto& ommatidium : built.ommatidia) {
    shares.push_back(ommatidium.cones[0].half_angle_rad / (rig.board.eye.acceptance_rad / 2.0));
  }
  const auto [mean, variance] = test::moments(shares);
  CHECK(std::fabs(mean - 1.0) < 4.0 * 0.05 / 40.0);
  CHECK(std::fabs(std::sqrt(variance) / 0.05 - 1.0) < 4.0 / std::sqrt(3200.0));
  for (const double spread : {0.01, 0.1}) {
    EffectRig small;
    small.board.build.acceptance_spread = spread;
    check_bounds(small, "acceptance_spread");
  }
}

TEST_CASE("refraction is Snell's: 60 degrees drawn at an index of 1.5 are 61.73") {
  EffectRig rig;
  CHECK(rig.called("refraction").empty());
  rig.board.build.refractive_index = 1.5;
  // Inside it is 20 degrees each side, of sine 0.34202.
  rig.board.eye.acceptance_rad = 60.0 * deg;
  const double half = rig.workings({"refraction"}).optics.ommatidia[0].cones[0].half_angle_rad;
  CHECK(std::sin(half) == doctest::Approx(1.5 * 0.34202014).epsilon(1e-7));
  CHECK(2.0 * half / deg == doctest::Approx(61.73).epsilon(1e-4));
  rig.board.eye.acceptance_rad = 120.0 * deg;
  rig.board.build.refractive_index = 2.5;
  CHECK(rig.workings({"refraction"}).optics.ommatidia[0].cones[0].half_angle_rad <= 60.0 * deg);
  EffectRig wide;
  wide.board.build.refractive_index = 1.5;
  wide.board.eye.acceptance_rad = 20.0 * deg;
  wide.board.object.width_mm = wide.board.object.height_mm = 16.0;
  check_bounds(wide, "refraction");
}

TEST_CASE("diffraction adds lambda over D in squares: 8 degrees through 25 um are 8.0986") {
  EffectRig rig;
  CHECK(rig.called("diffraction").empty());
  rig.board.build.lens_diameter_mm = 0.025;
  rig.board.eye.acceptance_rad = 8.0 * deg;
  // 0.55 um / 25 um = 1.26051 degrees; hypot(8, 1.26051) = 8.09870.
  CHECK(2.0 * rig.workings({"diffraction"}).optics.ommatidia[0].cones[0].half_angle_rad / deg ==
        doctest::Approx(8.09870).epsilon(1e-5));
  check_bounds(rig, "diffraction");
  rig.board.build.lens_diameter_mm = 0.01;
  check_bounds(rig, "diffraction");
}

TEST_CASE("bounds of soft and Airy profiles hold") {
  EffectRig rig;
  CHECK(rig.called("angular_profile").empty());
  rig.board.build.profile = hal::ProfileKind::soft;
  for (const double order : {2.0, 8.0, 32.0}) {
    rig.board.build.edge_order = order;
    CAPTURE(order);
    check_bounds(rig, "angular_profile");
  }
  rig.board.build.profile = hal::ProfileKind::airy;
  check_bounds(rig, "angular_profile");
}

TEST_CASE("coma looks away from the front by its share of D/2, inner shells by less") {
  EffectRig rig;
  CHECK(rig.called("coma").empty());
  rig.board.build.coma = 0.2;
  const sim::OpticsAsBuilt built = rig.workings({"coma"}).optics;
  const sim::OpticsAsBuilt drawn = sim::OpticsAsBuilt::drawn(rig.board.eye);
  for (std::size_t m = 0; m < built.ommatidia.size(); ++m) {
    const hal::Vec3 &now = built.ommatidia[m].cones[0].axis, &then = drawn.ommatidia[m].cones[0].axis;
    CHECK(angle(now, then) == doctest::Approx(0.2 * 0.07));
    CHECK(now.z < then.z);
    CHECK(now.x * then.y == doctest::Approx(now.y * then.x));
  }
  check_bounds(rig, "coma");
  rig.board.build.profile = hal::ProfileKind::soft;
  const auto shells = rig.workings({"angular_profile", "coma"}).optics.ommatidia[3].cones;
  for (const auto& shell : shells) {
    const double share = std::min(shell.half_angle_rad / 0.07, 1.0);
    CHECK(angle(shell.axis, drawn.ommatidia[3].cones[0].axis) == doctest::Approx(0.2 * 0.07 * share * share));
  }
  EffectRig odd(3, 3);
  odd.board.build.coma = 0.2;
  CHECK(odd.workings({"coma"}).optics.ommatidia[4].cones[0].axis.z == 1.0);
}

TEST_CASE("vignetting falls as cos^n along each ray and its bound holds") {
  EffectRig rig;
  CHECK(rig.called("vignetting").empty());
  rig.board.build.vignetting = 4.0;
  rig.board.eye.interommatidial_rad = 0.04;
  CHECK(rig.workings({"vignetting"}).optics.obliquity == 4.0);
  check_bounds(rig, "vignetting");
}

TEST_CASE("dust dims half of the view of its share of ommatidia, within the view") {
  EffectRig rig(40, 40);
  CHECK(rig.called("dust").empty());
  rig.board.build.dust_share = 0.15;
  CHECK_FALSE(rig.called("dust").empty());
  rig.board.build.dust_loss = 0.4;
  int dusty = 0;
  const sim::OpticsAsBuilt built = rig.workings({"dust"}).optics;
  for (const auto& ommatidium : built.ommatidia) {
    if (ommatidium.cones.size() == 1) continue;
    REQUIRE(ommatidium.cones.size() == 2);
    ++dusty;
    const auto &clean = ommatidium.cones[0], &shade = ommatidium.cones[1];
    CHECK(angle(clean.axis, shade.axis) + shade.half_angle_rad == doctest::Approx(clean.half_angle_rad));
    CHECK(shade.weight == doctest::Approx(-0.4));
    CHECK(std::pow(shade.half_angle_rad / clean.half_angle_rad, 2) == doctest::Approx(0.5));
  }
  CHECK(std::fabs(dusty - 240.0) < 4.0 * std::sqrt(1600.0 * 0.15 * 0.85));
  EffectRig small;
  small.board.build.dust_share = 0.3;
  check_bounds(small, "dust");
}

TEST_CASE("crosstalk gives a quarter of its share to each neighbour and keeps the sum") {
  EffectRig rig(3, 4, 0.0);
  CHECK(rig.called("crosstalk").empty());
  rig.board.build.crosstalk = 0.08;
  std::vector<double> levels(12, 0.0);
  levels[0] = 100.0;
  levels[6] = 1000.0;
  rig.look_at(levels);
  const std::vector<double> expected{96.0, 2.0, 20.0, 0.0, 2.0, 20.0, 920.0, 20.0, 0.0, 0.0, 20.0, 0.0};
  const auto played = rig.played({"crosstalk"});
  for (std::size_t m = 0; m < 12; ++m) CHECK(played[m] == doctest::Approx(expected[m]));
  EffectRig seen;
  seen.board.build.crosstalk = 0.02;
  test::look_at(seen, test::tried_pictures(seen.board.object)[0]);
  const double truth = seen.change({"crosstalk"});
  CHECK(seen.bound("crosstalk") >= truth);
  CHECK(seen.bound("crosstalk") <= 3.0 * truth);
}

TEST_CASE("the bound of crosstalk knows of light that flickers and of channels that differ") {
  EffectRig rig;
  rig.board.build.crosstalk = 0.02;
  rig.board.detector.integration_ms = 1.0;
  test::look_at(rig, test::tried_pictures(rig.board.object)[0]);
  const double still = rig.bound("crosstalk");
  rig.scene.light.mains_hz = 50.0;
  rig.scene.light.flicker_depth = 0.5;
  CHECK(rig.bound("crosstalk") > (1.0 + 0.5 * 0.9) * still);  // what is left after 1 ms
  rig.scene.light = {};
  CHECK(rig.bound("crosstalk") == still);
  // Half of the ommatidia lose 40 % before a scene that is as bright for all of them.
  EffectRig even;
  even.board.build.crosstalk = 0.02;
  even.preview.neighbour_rms = 0.0;
  CHECK(even.bound("crosstalk") == 0.0);
  even.board.build.dust_share = 0.5;
  even.board.build.dust_loss = 0.8;
  std::vector<double> levels(64, 1000.0);
  for (std::size_t m = 0; m < 64; m += 2) levels[m] = 600.0;
  EffectRig dusty = even;
  dusty.look_at(levels);
  CHECK(even.bound("crosstalk") >= dusty.change({"crosstalk"}));
}
