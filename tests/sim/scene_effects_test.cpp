#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/sim/plane_levels.hpp"

using namespace compueye;
using test::Brightness;
using test::EffectRig;

namespace {

using Levels = std::vector<double>;

Levels levels_of(const EffectRig& rig, const Brightness& bright) {
  return test::plane_levels(sim::OpticsAsBuilt::drawn(rig.board.eye), rig, bright);
}

void check_scene_bound(const EffectRig& rig, std::string_view name, double truth, double loosest = 10.0) {
  CAPTURE(name);
  CAPTURE(truth);
  CAPTURE(rig.preview.rms);
  REQUIRE_FALSE(rig.called(name).empty());
  CHECK(rig.bound(name) >= truth);
  CHECK(rig.bound(name) <= loosest * truth);
}

/// A rig before a sheet of pixel noise, with the preview's figures of it.
EffectRig noise_rig() {
  EffectRig rig;
  rig.scene = sim::scene_on(rig.board.object, "noise", test::pixel_noise());
  test::look_at(rig, test::brightness_of(test::pixel_noise(), rig.board.object));
  return rig;
}

const std::vector<std::string_view> all_that_moves{"motion", "motion_blur", "sampling_skew", "display_refresh"};

}  // namespace

TEST_CASE("a still flat grey scene on the object plane calls for nothing of scene or time") {
  EffectRig rig;
  for (const sim::Effect* effect : sim::effects()) {
    if (effect->group != sim::EffectGroup::scene && effect->group != sim::EffectGroup::timing) continue;
    CAPTURE(effect->name);
    CHECK(rig.called(effect->name).empty());
  }
  rig.scene.surfaces[0].motion.velocity_mm_per_s = {0.0, 0.0, 0.0};
  rig.scene.surfaces[0].shines = true;
  rig.scene.display.refresh_hz = 60.0;
  rig.board.detector.mux_channels = 8;
  rig.board.detector.mux_slot_us = 100.0;
  for (const std::string_view name : all_that_moves) CHECK(rig.called(name).empty());
}

TEST_CASE("motion is called for by what moves and bounded by the gradient over its way") {
  EffectRig rig = noise_rig();
  const Brightness still = test::brightness_of(test::pixel_noise(), rig.board.object);
  rig.scene.surfaces[0].motion.velocity_mm_per_s = {0.3, 0.4, 0.0};
  for (const double duration : {0.5, 1.0, 10.0}) {
    rig.scene.duration_s = duration;
    double squares = 0.0;
    constexpr int frames = 10;
    for (int f = 0; f < frames; ++f) {
      const double t = duration * (f + 0.5) / frames;
      const Levels moved = levels_of(rig, [&](double x, double y) { return still(x - 0.3 * t, y - 0.4 * t); });
      squares += std::pow(test::rms_difference(moved, rig.preview.levels), 2) / frames;
    }
    CAPTURE(duration);
    check_scene_bound(rig, "motion", std::sqrt(squares));
  }
  CHECK(rig.workings({"motion"}).render.motion);
  CHECK_FALSE(rig.workings({}).render.motion);
}

TEST_CASE("what moves while light is gathered blurs by the second derivative") {
  EffectRig rig = noise_rig();
  const Brightness still = test::brightness_of(test::pixel_noise(), rig.board.object);
  for (const double speed : {60.0, 150.0, 400.0}) {
    rig.scene.surfaces[0].motion.velocity_mm_per_s = {speed, 0.0, 0.0};
    const double way = speed * 0.01;
    const Levels blurred = levels_of(rig, [&](double x, double y) {
      double sum = 0.0;
      for (int k = 0; k < 20; ++k) sum += still(x - way * ((k + 0.5) / 20.0 - 0.5), y) / 20.0;
      return sum;
    });
    CAPTURE(speed);
    check_scene_bound(rig, "motion_blur", test::rms_difference(blurred, rig.preview.levels));
  }
  CHECK(rig.workings({"motion_blur"}).exposure.instants > 1);
  CHECK(rig.workings({"motion_blur"}).exposure.instants <= 16);
  CHECK(EffectRig().workings({"motion_blur"}).exposure.instants == 1);
}

TEST_CASE("channels that are read later see what has moved since") {
  EffectRig rig = noise_rig();
  const Brightness still = test::brightness_of(test::pixel_noise(), rig.board.object);
  rig.board.detector.mux_channels = 8;
  rig.board.detector.mux_slot_us = 500.0;
  rig.scene.surfaces[0].motion.velocity_mm_per_s = {0.0, 100.0, 0.0};
  Levels skewed(64);
  for (int turn = 0; turn < 8; ++turn) {
    const double way = 100.0 * 500e-6 * turn;
    const Levels at = levels_of(rig, [&](double x, double y) { return still(x, y - way); });
    for (std::size_t m = static_cast<std::size_t>(turn); m < 64; m += 8) skewed[m] = at[m];
  }
  check_scene_bound(rig, "sampling_skew", test::rms_difference(skewed, rig.preview.levels));
  CHECK(rig.workings({"sampling_skew"}).exposure.channels_in_turn);
  CHECK(rig.workings({"sampling_skew"}).exposure.scan_instants >= 2);
  rig.board.detector.mux_channels = 0;
  CHECK(rig.called("sampling_skew").empty());
}

TEST_CASE("a display moves in steps of its refresh, paper does not") {
  EffectRig rig = noise_rig();
  rig.scene.display.refresh_hz = 10.0;
  rig.scene.surfaces[0].motion.velocity_mm_per_s = {4.0, 0.0, 0.0};
  CHECK(rig.called("display_refresh").empty());
  rig.scene.surfaces[0].shines = true;
  const sim::Surface stepping = rig.workings({"display_refresh"}).scene.surfaces[0];
  CHECK(stepping.motion.moved(stepping.pose, 0.37).centre_mm.x == doctest::Approx(4.0 * 0.3));
  CHECK(stepping.motion.moved(stepping.pose, 0.09).centre_mm.x == 0.0);
  // Late by half a step in the mean; the rms of what lies between 0 and 0.4 mm.
  const Brightness still = test::brightness_of(test::pixel_noise(), rig.board.object);
  double squares = 0.0;
  for (int k = 0; k < 8; ++k) {
    const double late = 0.4 * (k + 0.5) / 8.0;
    const Levels then = levels_of(rig, [&](double x, double y) { return still(x + late, y); });
    squares += std::pow(test::rms_difference(then, rig.preview.levels), 2) / 8.0;
  }
  check_scene_bound(rig, "display_refresh", std::sqrt(squares));
}

TEST_CASE("what is nearer, farther or tilted is bounded by how far rays go aside on it") {
  const hal::Image picture = test::pixel_noise();
  for (const double depth : {1.0, 5.0, -3.0}) {
    EffectRig rig = noise_rig();
    rig.scene.surfaces[0].distance_mm = 30.0 + depth;
    const Brightness flat = test::brightness_of(picture, rig.board.object);
    const double z = rig.board.object.z_mm(rig.board.eye);
    const Levels deep =
        test::ray_levels(sim::OpticsAsBuilt::drawn(rig.board.eye), rig, [&](const hal::Vec3& apex, double x, double y) {
          const double far = (z + depth - apex.z) / (z - apex.z);
          return flat(apex.x + far * (x - apex.x), apex.y + far * (y - apex.y));
        });
    CAPTURE(depth);
    check_scene_bound(rig, "off_plane", test::rms_difference(deep, rig.preview.levels));
  }
  EffectRig tilted = noise_rig();
  const double angle = 0.3;
  tilted.scene.surfaces[0].pose.tilt_rad = angle;
  const Brightness flat = test::brightness_of(picture, tilted.board.object);
  const double z = tilted.board.object.z_mm(tilted.board.eye);
  const Levels seen = test::ray_levels(sim::OpticsAsBuilt::drawn(tilted.board.eye), tilted,
                                       [&](const hal::Vec3& a, double x, double y) {
                                         // a + s (p - a) on the plane z' = z + tan(angle) x'.
                                         const double t = std::tan(angle);
                                         const double s = (z + t * a.x - a.z) / ((z - a.z) - t * (x - a.x));
                                         return flat((a.x + s * (x - a.x)) / std::cos(angle), a.y + s * (y - a.y));
                                       });
  check_scene_bound(tilted, "off_plane", test::rms_difference(seen, tilted.preview.levels));
  CHECK(tilted.workings({"off_plane"}).render.true_depth);
  EffectRig moving = noise_rig();
  moving.scene.surfaces[0].motion.velocity_mm_per_s = {1.0, 0.0, 0.0};
  CHECK(moving.called("off_plane").empty());
  moving.scene.surfaces[0].motion.velocity_mm_per_s = {1.0, 0.0, 0.1};
  CHECK_FALSE(moving.called("off_plane").empty());
}

TEST_CASE("overlapping surfaces hide each other, those side by side do not") {
  EffectRig rig;
  sim::Surface card = rig.scene.surfaces[0];
  card.name = "card";
  card.width_mm = card.height_mm = 3.0;
  card.pose.centre_mm = {2.0, -1.0, 0.0};
  card.bands[0].pixels = {0.9F};
  rig.scene.surfaces.push_back(card);
  const auto on_card = [](double x, double y) { return std::fabs(x - 2.0) < 1.5 && std::fabs(y + 1.0) < 1.5; };
  const Brightness sheet = test::brightness_of(rig.scene.surfaces[0].picture(), rig.board.object);
  test::look_at(rig, [&](double x, double y) { return sheet(x, y) + (on_card(x, y) ? 0.9 : 0.0); });
  const Levels hidden = levels_of(rig, [&](double x, double y) { return on_card(x, y) ? 0.9 : sheet(x, y); });
  check_scene_bound(rig, "occlusion", test::rms_difference(hidden, rig.preview.levels));
  rig.scene.surfaces[1].pose.centre_mm.x = 6.0;
  CHECK(rig.called("occlusion").empty());
  rig.scene.surfaces[1].motion.velocity_mm_per_s.x = -1.0;
  CHECK_FALSE(rig.called("occlusion").empty());
}

TEST_CASE("a display shows its picture to the power of gamma above its black") {
  EffectRig rig = noise_rig();
  rig.scene.display.gamma = 2.2;
  rig.scene.display.black_level = 0.05;
  CHECK(rig.called("display_response").empty());  // paper
  CHECK(rig.workings({"display_response"}).scene.surfaces[0].picture().pixels == test::pixel_noise().pixels);
  rig.scene.surfaces[0].shines = true;
  hal::Image shown = test::pixel_noise();
  for (float& pixel : shown.pixels) pixel = static_cast<float>(0.05 + 0.95 * std::pow(double(pixel), 2.2));
  const hal::Image told = rig.workings({"display_response"}).scene.surfaces[0].picture();
  for (std::size_t n = 0; n < shown.pixels.size(); ++n) CHECK(told.pixels[n] == doctest::Approx(shown.pixels[n]));
  const Levels levels = levels_of(rig, test::brightness_of(shown, rig.board.object));
  check_scene_bound(rig, "display_response", test::rms_difference(levels, rig.preview.levels));
}

TEST_CASE("a display's pixels run into each other by less than the second derivative says") {
  EffectRig rig = noise_rig();
  rig.scene.display.pixel_blur = 0.8;
  CHECK(rig.called("pixel_blur").empty());
  rig.scene.surfaces[0].shines = true;
  CHECK(rig.workings({"pixel_blur"}).render.pixel_edge_blur == 0.8);
  hal::Image coarse(4, 4);
  for (std::size_t n = 0; n < 16; ++n) coarse.pixels[n] = test::pixel_noise().pixels[n];
  rig.scene.surfaces[0].bands = {coarse};
  const Brightness sharp = test::brightness_of(coarse, rig.board.object);
  test::look_at(rig, sharp);
  const double strip = 0.8 * 2.0;
  const Levels blurred = levels_of(rig, [&](double x, double y) {
    double sum = 0.0;
    for (int i = 0; i < 10; ++i) {
      for (int k = 0; k < 10; ++k)
        sum += sharp(x + strip * ((k + 0.5) / 10 - 0.5), y + strip * ((i + 0.5) / 10 - 0.5)) / 100;
    }
    return sum;
  });
  check_scene_bound(rig, "pixel_blur", test::rms_difference(blurred, rig.preview.levels));
}

TEST_CASE("the lamp's light falls off with the square of the distance from the middle") {
  EffectRig rig = noise_rig();
  rig.scene.light.falloff = 0.4;
  const double corner2 = 32.0;
  const Brightness even = test::brightness_of(test::pixel_noise(), rig.board.object);
  const Levels expected =
      levels_of(rig, [&](double x, double y) { return even(x, y) * (1.0 - 0.4 * (x * x + y * y) / corner2); });
  check_scene_bound(rig, "light_falloff", test::rms_difference(expected, rig.preview.levels));
  const hal::Image lit = rig.workings({"light_falloff"}).scene.surfaces[0].picture();
  const Levels told = levels_of(rig, test::brightness_of(lit, rig.board.object));
  CHECK(test::rms_difference(told, expected) < 2e-3 * rig.preview.rms);
  rig.scene.surfaces[0].shines = true;
  CHECK(rig.called("light_falloff").empty());
}

TEST_CASE("coloured pictures are weighed by lamp and eye, grey ones and even eyes call for nothing") {
  EffectRig rig = noise_rig();
  rig.board.detector.spectral_response = {0.2, 1.0, 0.6};
  CHECK(rig.called("spectral_response").empty());
  sim::Surface& sheet = rig.scene.surfaces[0];
  sheet.bands = {test::pixel_noise(0), test::pixel_noise(1), test::pixel_noise(2)};
  CHECK_FALSE(rig.called("spectral_response").empty());
  rig.scene.light.spectrum = {1.0, 0.5, 0.25};
  hal::Image mean = test::pixel_noise(), seen = mean;
  for (std::size_t n = 0; n < mean.pixels.size(); ++n) {
    const double r = sheet.bands[0].pixels[n], g = sheet.bands[1].pixels[n], b = sheet.bands[2].pixels[n];
    mean.pixels[n] = static_cast<float>((r + g + b) / 3.0);
    seen.pixels[n] = static_cast<float>((0.2 * r + 0.5 * g + 0.15 * b) / 0.85);
  }
  const auto told = rig.workings({"spectral_response"}).scene.surfaces[0].bands;
  REQUIRE(told.size() == 1);
  for (std::size_t n = 0; n < seen.pixels.size(); ++n) CHECK(told[0].pixels[n] == doctest::Approx(seen.pixels[n]));
  test::look_at(rig, test::brightness_of(mean, rig.board.object));
  const Levels weighed = levels_of(rig, test::brightness_of(seen, rig.board.object));
  check_scene_bound(rig, "spectral_response", test::rms_difference(weighed, rig.preview.levels));
  rig.board.detector.spectral_response = {1.0, 2.0, 4.0};
  CHECK(rig.called("spectral_response").empty());
}

TEST_CASE("the lamp drifts linearly in time") {
  EffectRig rig(2, 2, 1000.0);
  rig.scene.duration_s = 1800.0;
  rig.board.frame_rate_hz = 0.1;
  rig.scene.light.drift_per_hour = -0.02;
  const auto frames = rig.play({"lamp_drift"}, 181);
  CHECK(frames[0][0] == 1000.0);
  CHECK(frames[180][3] == doctest::Approx(990.0));
  check_scene_bound(rig, "lamp_drift", rig.change({"lamp_drift"}, 180));
  rig.scene.duration_s = 0.05;  // the lamp does not begin anew with the scene
  check_scene_bound(rig, "lamp_drift", rig.change({"lamp_drift"}, 360));
  rig.scene.surfaces[0].shines = true;
  CHECK(rig.called("lamp_drift").empty());
}

TEST_CASE("flicker of the mains is averaged over the integration time") {
  EffectRig rig(2, 2, 1000.0);
  rig.board.frame_rate_hz = 80.0;
  rig.board.detector.integration_ms = 4.0;
  rig.scene.light.mains_hz = 50.0;
  rig.scene.light.flicker_depth = 0.2;
  const auto frames = rig.play({"mains_flicker"}, 40);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    double mean = 0.0;  // of the light itself, over the frame's own time
    for (int k = 0; k < 400; ++k) {
      const double t = static_cast<double>(f) / 80.0 + 0.004 * (k + 0.5) / 400.0;
      mean += (1.0 + 0.2 * std::sin(2.0 * std::numbers::pi * 100.0 * t)) / 400.0;
    }
    CHECK(frames[f][1] == doctest::Approx(1000.0 * mean).epsilon(1e-5));
  }
  check_scene_bound(rig, "mains_flicker", rig.change({"mains_flicker"}, 40));
  for (const double whole_ms : {10.0, 20.0, 40.0}) {
    rig.board.frame_rate_hz = 20.0;
    rig.board.detector.integration_ms = whole_ms;
    CHECK(rig.called("mains_flicker").empty());
  }
  rig.scene.light.mains_hz = 60.0;
  rig.board.detector.integration_ms = 1000.0 / 120.0;
  CHECK(rig.called("mains_flicker").empty());
}
