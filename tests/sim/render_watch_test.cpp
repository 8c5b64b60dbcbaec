// Whoever waits for a rendering is told how far it is, and may give it up.

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/simulated_eye.hpp"

using namespace compueye;
using hal::ErrorCode;
using sim::SimulatedEye;
using sim::SimulatedEyeSettings;

namespace {

constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max();

SimulatedEyeSettings moving_scene() {
  SimulatedEyeSettings settings;
  settings.board.eye.interommatidial_rad = 0.026;
  settings.board.eye.acceptance_rad = 0.14;
  settings.board.sensor.full_scale = 128.0;
  settings.scenes = {sim::scene_on(settings.board.object, "fig2", sim::render_built_in("fig2", 16, 16, 0).value())};
  settings.scenes[0].surfaces[0].motion.velocity_mm_per_s = {1.0, 0.0, 0.0};
  return settings;
}

}  // namespace

TEST_CASE("a rendering that its watch gives up loses no frame, and one at the beginning makes no eye") {
  hal::VirtualClock clock;
  SimulatedEyeSettings settings = moving_scene();
  const auto undisturbed = SimulatedEye::create(settings, clock).value();
  bool go_on = true;
  std::string told;
  const auto eye = SimulatedEye::create(settings, clock).value();
  eye->watch([&](std::string_view what, double) {
    told = what;
    return go_on;
  });
  REQUIRE(eye->start().has_value());
  REQUIRE(undisturbed->start().has_value());
  for (std::uint64_t f = 0; f < 6; ++f) {
    go_on = f % 2 == 0;
    if (!go_on) CHECK(eye->read(forever).error().code == ErrorCode::timeout);
    go_on = true;
    const auto block = eye->read(forever);
    REQUIRE(block.has_value());
    CHECK(block->frame == f);
    CHECK(std::ranges::equal(block->codes, undisturbed->read(forever)->codes));
  }
  CHECK(told == "rendering");
  told.clear();
  CHECK(eye->noise_free(5).size() == 64);
  CHECK(eye->levels_lsb(5).size() == 64);
  CHECK(told.empty());  // of frame 5 all is there
  CHECK(eye->account().delivered == 6);
  CHECK(eye->account().produced == 6);

  std::vector<std::string> stages;
  settings.planning.watch = [&](std::string_view what, double) {
    if (stages.empty() || stages.back() != what) stages.emplace_back(what);
    return stages.size() < 2;
  };
  const auto none = SimulatedEye::create(settings, clock);
  REQUIRE_FALSE(none.has_value());
  CHECK(none.error().code == ErrorCode::interrupted);
  CHECK(stages == std::vector<std::string>{"looking at the scene", "rendering"});
}
