// What render settings leave out, what is not rendered again, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "sim/render/renderer.hpp"
#include "tests/memory/allocation_counter.hpp"
#include "tests/sanitized.hpp"
#include "tests/sim/render_rig.hpp"

using namespace compueye;
using sim::OpticsAsBuilt;
using sim::Renderer;
using sim::Scene;
using sim::scene_on;
using test::deg;
using test::largest_difference;
using test::picture_of;
using test::rendered;
using test::RenderRig;
using test::small_eye;
using test::wide_eye;

TEST_CASE("with everything off surfaces lie flat on the object plane as they stand at first, later ones on top") {
  RenderRig rig = small_eye(20.0);
  Scene plain = scene_on(rig.object, "bars", picture_of("bars", rig.object));
  plain.surfaces[0].pose.centre_mm = {1.0, -0.5, 0.0};
  const std::vector<double> expected = rendered(rig, plain);
  Scene scene = plain;
  scene.surfaces[0].distance_mm = 12.0;
  scene.surfaces[0].pose.tilt_rad = 30.0 * deg;
  scene.surfaces[0].motion.velocity_mm_per_s = {1.0, 2.0, 3.0};
  rig.settings.true_depth = false;
  CHECK(rendered(rig, scene, 5.0) == expected);
  rig.settings.motion = true;
  plain.surfaces[0].pose.centre_mm = {6.0, 9.5, 0.0};
  CHECK(largest_difference(rendered(rig, scene, 5.0), rendered(rig, plain)) < 1e-9);

  Scene two = scene_on(rig.object, "white", hal::Image(1, 1, 1.0F));
  two.surfaces.push_back(two.surfaces[0]);
  two.surfaces[1].bands = {hal::Image(2, 1)};
  two.surfaces[1].bands[0].at(0, 0) = 1.0F;
  two.surfaces[1].height_mm = two.surfaces[1].width_mm = 4.0;
  hal::Image covered(4, 4, 1.0F);
  covered.at(2, 1) = covered.at(2, 2) = 0.0F;
  rig.settings.occlusion = true;
  const std::vector<double> on_top = rendered(rig, scene_on(rig.object, "covered", covered));
  CHECK(largest_difference(rendered(rig, two), on_top) < 2.0 * rig.settings.tolerance);
  std::swap(two.surfaces[0], two.surfaces[1]);
  const std::vector<double> white = rendered(rig, scene_on(rig.object, "white", hal::Image(1, 1, 1.0F)));
  CHECK(largest_difference(rendered(rig, two), white) < 2.0 * rig.settings.tolerance);
}

TEST_CASE("of several bands the mean is rendered") {
  const RenderRig rig = small_eye();
  Scene scene = scene_on(rig.object, "bands", picture_of("bars", rig.object));
  std::vector<double> third = rendered(rig, scene);
  for (double& value : third) value /= 3.0;
  scene.surfaces[0].bands.push_back(hal::Image(16, 16));
  scene.surfaces[0].bands.push_back(hal::Image(16, 16));
  CHECK(largest_difference(rendered(rig, scene), third) < 1e-5);
}

// Against the ramps drawn out in a picture 32 times finer.
TEST_CASE("pixel edges of a display are ramps of a share of a pixel") {
  RenderRig rig = small_eye(6.0);
  const hal::Image coarse = picture_of("dots", rig.object, 3);
  for (const double share : {0.25, 0.5, 1.0}) {
    if (test::sanitized && share != 0.25) continue;
    CAPTURE(share);
    constexpr int factor = 32;
    hal::Image fine(18 * factor, 18 * factor);  // a pixel of dark around it, into which the edge runs
    const int window = static_cast<int>(share * factor);
    const auto coarse_at = [&](int r, int c) {
      const int row = r / factor - 1, col = c / factor - 1;
      return row < 0 || col < 0 || row > 15 || col > 15 ? 0.0F : coarse.at(row, col);
    };
    for (int r = window / 2; r < fine.rows - window / 2; ++r) {
      for (int c = window / 2; c < fine.cols - window / 2; ++c) {
        float sum = 0.0F;
        const auto share_of = [&](int off) { return std::abs(off) == window / 2 ? 0.5F : 1.0F; };
        for (int dr = -window / 2; dr <= window / 2; ++dr) {
          for (int dc = -window / 2; dc <= window / 2; ++dc)
            sum += share_of(dr) * share_of(dc) * coarse_at(r + dr, c + dc);
        }
        fine.at(r, c) = sum / static_cast<float>(window * window);
      }
    }
    Scene drawn = scene_on(rig.object, "drawn", fine);
    drawn.surfaces[0].width_mm = drawn.surfaces[0].height_mm = 9.0;
    const std::vector<double> expected = rendered(rig, drawn);
    Scene scene = scene_on(rig.object, "dots", coarse);
    rig.settings.pixel_edge_blur = share;
    const std::vector<double> printed = rendered(rig, scene);
    scene.surfaces[0].shines = true;
    const std::vector<double> shown = rendered(rig, scene);
    rig.settings.pixel_edge_blur = 0.0;
    CHECK(printed == rendered(rig, scene));
    const double effect = largest_difference(expected, printed);
    CHECK(effect > 0.002);
    CHECK(largest_difference(expected, shown) < 0.1 * effect);
  }
}

TEST_CASE("what did not move costs nothing, and what moved in front is taken off and put back") {
  RenderRig rig = wide_eye();
  rig.settings.motion = rig.settings.occlusion = true;
  Scene scene = scene_on(rig.object, "line art", picture_of("line-art", rig.object));
  scene.surfaces[0].pose.tilt_rad = 10.0 * deg;
  sim::Surface front;
  front.name = "front";
  front.bands = {picture_of("dots", rig.object)};
  front.width_mm = front.height_mm = 5.0;
  front.distance_mm = 6.0;
  front.motion.start_s = 1.0;
  front.motion.velocity_mm_per_s = {8.0, 0.0, 0.0};
  scene.surfaces.push_back(front);
  auto renderer = Renderer::create(rig.eye, rig.object, OpticsAsBuilt::drawn(rig.eye), rig.settings, scene);
  REQUIRE(renderer.has_value());
  std::vector<double> signals(400);
  renderer->render(0.0, signals);
  CHECK(renderer->surfaces_rendered() == 2);
  const std::vector<double> before = signals;
  renderer->render(0.5, signals);
  CHECK(renderer->surfaces_rendered() == 0);
  CHECK(signals == before);
  for (const double t : {1.5, 2.0, 1.2, 9.0}) {
    renderer->render(t, signals);
    CHECK(renderer->surfaces_rendered() == 2);
    CHECK(signals == rendered(rig, scene, t));
  }
  renderer->render(0.0, signals);
  CHECK(signals == before);
  scene.surfaces[1].motion.velocity_mm_per_s = {0.0, 0.0, -4.0};
  renderer->render(9.0, signals);  // it is in the eye by now
  scene.surfaces.pop_back();
  CHECK(largest_difference(signals, rendered(rig, scene)) < 2.0 * rig.settings.tolerance);
}

TEST_CASE("a rendering that is given up is done anew, from any place") {
  RenderRig rig = wide_eye();
  rig.settings.motion = rig.settings.occlusion = true;
  Scene scene = scene_on(rig.object, "line art", picture_of("line-art", rig.object));
  scene.surfaces.push_back(scene.surfaces[0]);
  scene.surfaces.back().width_mm = scene.surfaces.back().height_mm = 4.0;
  scene.surfaces.back().distance_mm = 8.0;
  scene.surfaces.back().motion.velocity_mm_per_s = {1.0, 0.0, 0.0};
  auto renderer = Renderer::create(rig.eye, rig.object, OpticsAsBuilt::drawn(rig.eye), rig.settings, scene);
  REQUIRE(renderer.has_value());
  std::vector<double> signals(400), expected(400);
  int told = 0;
  double last = -1.0;
  CHECK(renderer->render(0.3, expected, [&](double share) {
    CHECK(share > last);
    CHECK(share <= 1.0);
    last = share;
    ++told;
    return true;
  }));
  CHECK(last > 0.3);
  REQUIRE(told > 800);
  for (const int given_up_at : {1, 250, 400, 410}) {
    int left = given_up_at;
    REQUIRE(renderer->render(0.6, signals));
    REQUIRE_FALSE(renderer->render(0.3, signals, [&](double) { return --left > 0; }));
    CHECK(renderer->render(0.3, signals));
    CHECK(signals == expected);
  }
}

TEST_CASE("frames after the first do not allocate, and renderers in threads do not disturb each other") {
  RenderRig rig = wide_eye();
  rig.settings.motion = rig.settings.occlusion = true;
  Scene scene = scene_on(rig.object, "line art", picture_of("line-art", rig.object));
  for (int k = 1; k < 4; ++k) {
    scene.surfaces.push_back(scene.surfaces[0]);
    scene.surfaces.back().width_mm = scene.surfaces.back().height_mm = 3.0 * k;
    scene.surfaces.back().distance_mm = 10.0 - 2.0 * k;
    scene.surfaces.back().motion.velocity_mm_per_s = {static_cast<double>(k), 1.0, 0.0};
    scene.surfaces.back().motion.tilt_rad_per_s = 0.1 * k;
  }
  const auto make = [&] {
    return Renderer::create(rig.eye, rig.object, OpticsAsBuilt::drawn(rig.eye), rig.settings, scene);
  };
  auto renderer = make();
  REQUIRE(renderer.has_value());
  std::vector<double> signals(400);
  renderer->render(0.0, signals);
  const tests::HeapUse begin = tests::heap_use_of_this_thread();
  renderer->render(0.3, signals);
  renderer->render(0.6, signals);
  CHECK((tests::heap_use_of_this_thread() - begin).calls() == 0);

  std::vector<std::vector<double>> others(3, std::vector<double>(400));
  std::vector<std::thread> threads;
  for (std::vector<double>& other : others) {
    threads.emplace_back([&make, &other] { make()->render(0.6, other); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& other : others) CHECK(other == signals);
}

TEST_CASE("what cannot be rendered is refused by name") {
  const RenderRig usual = small_eye();
  const Scene white = scene_on(usual.object, "white", hal::Image(1, 1, 1.0F));
  const auto error = [](const RenderRig& rig, const OpticsAsBuilt& optics, const Scene& scene) {
    const auto result = Renderer::create(rig.eye, rig.object, optics, rig.settings, scene);
    REQUIRE_FALSE(result.has_value());
    return result.error();
  };
  const auto place = [&](const RenderRig& rig) {
    const hal::Error found = error(rig, OpticsAsBuilt::drawn(rig.eye), white);
    CHECK(found.code == hal::ErrorCode::out_of_range);
    return found.place;
  };
  RenderRig rig = usual;
  rig.object.width_mm = -1.0;
  CHECK(place(rig) == "object.width_mm");
  rig = usual;
  rig.eye.acceptance_rad = std::nan("");
  CHECK(place(rig) == "eye.acceptance_angle_deg");
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    rig = usual;
    rig.settings.tolerance = bad;
    CHECK(place(rig) == "render.tolerance");
  }
  rig = usual;
  rig.settings.pixel_edge_blur = 1.5;
  CHECK(place(rig) == "render.pixel_edge_blur");

  OpticsAsBuilt optics = OpticsAsBuilt::drawn(usual.eye);
  optics.ommatidia.pop_back();
  CHECK(error(usual, optics, white).code == hal::ErrorCode::mismatch);
  for (const sim::ConeOfLight& cone :
       {sim::ConeOfLight{{0, 0, 1}, 61.0 * deg, 1.0}, sim::ConeOfLight{{0, 0, 1}, 0.0, 1.0},
        sim::ConeOfLight{{0, 0, 1}, 0.1, std::nan("")}, sim::ConeOfLight{{0, 0, 2}, 0.1, 1.0}}) {
    optics = OpticsAsBuilt::drawn(usual.eye);
    optics.ommatidia[5].cones = {cone};
    CHECK(error(usual, optics, white).place == "optics of ommatidium 5");
  }
  Scene inside = white;
  inside.surfaces[0].distance_mm = 3.0;
  inside.surfaces[0].pose.tilt_rad = 60.0 * deg;
  const hal::Error reaching = error(usual, OpticsAsBuilt::drawn(usual.eye), inside);
  CHECK(reaching.code == hal::ErrorCode::out_of_range);
  CHECK(reaching.place == "white");
}
