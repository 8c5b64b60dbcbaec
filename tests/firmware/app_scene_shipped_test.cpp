#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "sim/plan/plan.hpp"
#include "sim/plan/preview.hpp"
#include "tests/sanitized.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
namespace fs = std::filesystem;

namespace {

std::vector<fs::path> shipped_scenes() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(compueye::test::source_path("scenes"))) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("every scene that comes with the project can be seen by every board") {
  const std::vector<fs::path> scenes = shipped_scenes();
  CHECK(scenes.size() >= 10);
  int boards = 0;
  for (const auto& entry : fs::directory_iterator(compueye::test::source_path("boards"))) {
    if (!fs::exists(entry.path() / "board.toml")) continue;
    if (compueye::test::sanitized && ++boards > 1) continue;
    const auto board = load_board(entry.path());
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    CAPTURE(board->name);
    for (const fs::path& file : scenes) {
      CAPTURE(file.string());
      const auto scene = choose_scene(*board, {file.string(), 0, std::nullopt});
      REQUIRE_MESSAGE(scene.has_value(), scene.error().text());
      CHECK(scene->name == file.stem());
      // Finer than the pixels of the reconstruction, where a picture is more than one colour.
      for (const sim::Surface& surface : scene->surfaces) {
        const hal::Image& picture = surface.picture();
        if (picture.rows < 100 || surface.shines) continue;
        CHECK(surface.height_mm / picture.rows < board->object.pixel_height_mm());
      }
    }
  }
}

TEST_CASE("every scene says in a line what it calls for, and the list of them knows it") {
  const std::string list = content_of(compueye::test::source_path("scenes/README.md"));
  for (const fs::path& file : shipped_scenes()) {
    CAPTURE(file.string());
    const std::string text = content_of(file);
    CHECK((text.starts_with("# Calls for ") || text.starts_with("# Forces ")));
    CHECK(text.find("description = ") != std::string::npos);
    CHECK(list.find("| `" + file.filename().string() + "` |") != std::string::npos);
  }
}

TEST_CASE("the scenes call for what their list says, and the still ones for nothing of scene and time") {
  struct Case {
    const char* board;
    const char* scene;
    std::vector<std::string_view> effects;
  };
  const std::vector<std::string_view> none;
  const std::vector<Case> cases{
      {"sim-8x8", "star", none},
      {"sim-8x8", "text", none},
      {"sim-8x8", "slanted-edge", none},
      {"sim-8x8-detector", "moving-bar", {"motion", "motion_blur", "sampling_skew"}},
      {"sim-8x8", "turntable", {"motion", "motion_blur"}},
      {"sim-8x8", "tilted", {"off_plane"}},
      {"sim-8x8", "approach", {"off_plane", "motion", "motion_blur"}},
      {"sim-8x8", "behind-a-bar", {"off_plane", "occlusion", "motion", "motion_blur"}},
      {"sim-8x8", "two-depths", {"off_plane", "occlusion"}},
      {"sim-8x8", "ball", {"off_plane"}},
      {"sim-8x8", "relief", {"off_plane", "occlusion"}},
      {"sim-8x8-detector", "mains", {"mains_flicker"}},
      {"sim-8x8", "lamp-drift", {"light_falloff", "lamp_drift"}},
      {"sim-8x8", "colours", {"spectral_response"}},
      {"sim-8x8", "display", {"motion", "motion_blur", "display_response", "pixel_blur", "display_refresh"}},
  };
  for (const Case& c : cases) {
    if (compueye::test::sanitized && std::string_view(c.scene) == "relief") continue;  // a third of a minute
    CAPTURE(c.scene);
    const Board board = load_board(compueye::test::source_path(std::string("boards/") + c.board)).value();
    const std::string file = compueye::test::source_path(std::string("scenes/") + c.scene + ".toml");
    const sim::Scene scene = choose_scene(board, {file, 0, std::nullopt}).value();
    const auto settings = simulated_eye_settings(board, scene, 1);
    const auto preview = sim::preview_of(settings.board, scene);
    REQUIRE_MESSAGE(preview.has_value(), preview.error().text());
    const sim::Plan plan = sim::plan_effects({settings.board, scene, *preview}, sim::Sensitivity::of_small_eye());
    std::vector<std::string_view> called;
    for (const sim::PlannedEffect& each : plan.effects) {
      const bool of_scene =
          each.effect->group == sim::EffectGroup::scene || each.effect->group == sim::EffectGroup::timing;
      if (of_scene && !each.called_for_by.empty()) called.push_back(each.effect->name);
    }
    std::vector<std::string_view> listed = c.effects;
    std::sort(called.begin(), called.end());
    std::sort(listed.begin(), listed.end());
    CHECK(called == listed);
  }
}
