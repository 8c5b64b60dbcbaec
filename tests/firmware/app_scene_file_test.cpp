#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/scene/scene_file.hpp"
#include "firmware/eye/scene/scene_settings.hpp"
#include "firmware/files/png.hpp"
#include "tests/firmware/app_board_text.hpp"
#include "tests/firmware/app_scene_text.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using firmware::test::good_scene;
using firmware::test::replaced;
using firmware::test::some_site;
namespace fs = std::filesystem;

namespace {

using compueye::test::deg;

sim::Scene good(const std::string& text, const SceneSite& site = some_site()) {
  auto scene = parse_scene(text, "scene.toml", site);
  REQUIRE_MESSAGE(scene.has_value(), scene.error().text());
  return std::move(*scene);
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("a scene file is read in natural units, with every default") {
  const sim::Scene scene = good(good_scene);
  CHECK(scene.name == "scene");
  CHECK(scene.duration_s == 5.0);
  CHECK(scene.light.level == 2.0);
  CHECK(scene.light.mains_hz == 0.0);
  CHECK(scene.display.gamma == 2.2);
  CHECK(scene.effects == std::map<std::string, sim::Forced>{{"motion", sim::Forced::on}});
  REQUIRE(scene.surfaces.size() == 2);

  const sim::Surface& card = scene.surfaces[0];
  CHECK(card.name == "card");
  CHECK(card.shape == sim::Shape::plane);
  CHECK(card.bands.size() == 1);
  CHECK(card.picture().rows == 32);
  CHECK(card.picture().cols == 64);
  CHECK(card.width_mm == 6.0);
  CHECK(card.height_mm == 3.0);  // in proportion
  CHECK(card.distance_mm == 25.0);
  CHECK(card.pose.tilt_rad == doctest::Approx(30.0 * deg).epsilon(1e-15));
  CHECK(card.motion.velocity_mm_per_s.y == -2.0);
  CHECK(card.motion.velocity_mm_per_s.z == 0.5);
  CHECK_FALSE(card.shines);

  const sim::Surface& sheet = scene.surfaces[1];
  CHECK(sheet.name == "surface 2");
  REQUIRE(sheet.bands.size() == 3);
  CHECK(sheet.bands[1].at(3, 3) == 0.5F);
  CHECK(sheet.bands[2].at(3, 3) == 0.0F);
  CHECK(sheet.shines);
  CHECK_FALSE(sheet.distance_mm.has_value());
  CHECK(sheet.width_mm == 8.0);  // as large as the plane of 8.5 x 8 allows
  CHECK(sheet.height_mm == 8.0);
  CHECK(sheet.motion.repeats);
  // From its own place on.
  REQUIRE(sheet.motion.path.size() == 3);
  CHECK(sheet.motion.path[0].t_s == 0.0);
  CHECK(sheet.motion.path[0].offset_mm.z == 0.0);
  CHECK(sheet.motion.path[1].offset_mm.z == 5.0);
  CHECK(sheet.motion.path[2].t_s == 2.0);

  const sim::Scene least = good("[[surface]]\npicture = \"text\"\n");
  CHECK(least.surfaces[0].picture().rows == 640);
  CHECK(least.duration_s == 0.0);
  CHECK(least.still());
}

TEST_CASE("sizes follow from each other, from the picture and from the plane") {
  const auto sized = [](const std::string& keys) {
    return good("[[surface]]\npicture = \"white\"\nresolution = [10, 20]\n" + keys).surfaces[0];
  };
  CHECK(sized("").width_mm == 8.5);
  CHECK(sized("").height_mm == 4.25);
  CHECK(sized("height_mm = 3").width_mm == 6.0);
  CHECK(sized("width_mm = 3").height_mm == 1.5);
  CHECK(sized("width_mm = 3\nheight_mm = 5").height_mm == 5.0);
  CHECK(sized("shape = \"sphere\"").width_mm == 4.25);
  CHECK(sized("shape = \"sphere\"").height_mm == 4.25);
  CHECK(sized("shape = \"sphere\"\nwidth_mm = 3").height_mm == 3.0);
}

TEST_CASE("a relief has the heights of its picture, in mm") {
  const sim::Scene scene = good(
      "[[surface]]\npicture = \"white\"\nresolution = [16, 16]\nshape = \"relief\"\nheights = \"fig2\"\n"
      "relief_mm = 1.5\n");
  const hal::Image& heights = scene.surfaces[0].heights;
  REQUIRE(heights.rows == 16);
  CHECK(heights.at(3, 4) == 1.5F);
  CHECK(heights.at(0, 0) == 0.0F);
}

TEST_CASE("lengths are scaled with the plane that a file is for") {
  const std::string text =
      "[scene]\nfor_plane_mm = [17, 15]\n[[surface]]\npicture = \"white\"\nwidth_mm = 4\nx_mm = 2\ny_mm = -3\n"
      "distance_mm = 20\nvelocity_mm_per_s = [1, 2, 3]\npath = [[1, 4, 5, 6]]\n";
  const sim::Surface s = good(text + "").surfaces[0];  // half as wide, twice as far
  CHECK(s.width_mm == 2.0);
  CHECK(s.pose.centre_mm.x == 1.0);
  CHECK(s.pose.centre_mm.y == -1.5);
  CHECK(s.distance_mm == 40.0);
  CHECK(s.motion.velocity_mm_per_s.x == 0.5);
  CHECK(s.motion.velocity_mm_per_s.z == 6.0);
  CHECK(s.motion.path[1].offset_mm.y == 2.5);
  CHECK(s.motion.path[1].offset_mm.z == 12.0);
  CHECK(s.motion.path[1].t_s == 1.0);
  const sim::Surface relief =
      good(
          "[scene]\nfor_plane_mm = [17, 15]\n[[surface]]\npicture = \"white\"\nshape = \"relief\"\n"
          "heights = \"white\"\nresolution = [2, 2]\nrelief_mm = 1.5\n")
          .surfaces[0];
  CHECK(relief.heights.at(0, 0) == 3.0F);
}

TEST_CASE("--scene-distance moves what says no distance of its own") {
  SceneSite site = some_site();
  site.distance_mm = 50.0;
  const sim::Scene scene = good(good_scene, site);
  CHECK(scene.surfaces[0].distance_mm == 25.0);
  CHECK(scene.surfaces[1].distance_mm == 50.0);
  compueye::test::check_error(parse_scene("[[surface]]\npicture = \"white\"\ndistance_mm = 20\n", "scene.toml", site),
                              hal::ErrorCode::mismatch, "scene.toml", {"distance_mm", "--scene-distance"});
}

TEST_CASE("pictures lie beside the scene file, and colours have three bands") {
  const compueye::test::TemporaryFolder folder;
  RgbImage rgb{2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}};
  REQUIRE(write_png(folder / "colour.png", rgb).has_value());
  REQUIRE(write_png(folder / "grey.png", hal::Image(3, 4, 0.2F), 16).has_value());
  std::ofstream(folder / "Scene.TOML") << "[[surface]]\npicture = \"colour.png\"\ncolour = [1, 0.5, 2]\n"
                                          "[[surface]]\npicture = \"grey.png\"\ncolour = [2, 2, 2]\n";
  const auto scene = load_scene(folder / "Scene.TOML", some_site());
  REQUIRE_MESSAGE(scene.has_value(), scene.error().text());
  CHECK(scene->name == "Scene");
  const auto& bands = scene->surfaces[0].bands;
  REQUIRE(bands.size() == 3);
  CHECK(bands[0].pixels == std::vector<float>{1.0F, 0.0F, 0.0F, 1.0F});
  CHECK(bands[1].pixels == std::vector<float>{0.0F, 0.5F, 0.0F, 0.5F});
  CHECK(bands[2].pixels == std::vector<float>{0.0F, 0.0F, 2.0F, 2.0F});
  REQUIRE(scene->surfaces[1].bands.size() == 1);
  CHECK(scene->surfaces[1].picture().at(2, 3) == doctest::Approx(0.4).epsilon(1e-4));

  // The command line and a board choose it alike.
  Board board = parse_board(firmware::test::good_board, "board.toml").value();
  const auto chosen = choose_scene(board, {(folder / "Scene.TOML").string(), 0, std::nullopt});
  REQUIRE_MESSAGE(chosen.has_value(), chosen.error().text());
  CHECK(chosen->surfaces.size() == 2);
  board.folder = folder.path().string();
  board.scene.name = "Scene.TOML";
  CHECK(choose_scene(board, {}).has_value());
  CHECK(choose_scene(board, {{}, 3, std::nullopt}).error().place == "--scene-seed");
}

TEST_CASE("every default of a scene file is itself a good value, and every range is one that sim takes") {
  for (const auto& row : scene_settings()) {
    CAPTURE(std::string(row.key));
    if (row.fallback) CHECK(check_value(row, *row.fallback).has_value());
  }
  const double inf = std::numeric_limits<double>::infinity();
  int judged = 0;
  for (const auto& row : surface_settings()) {
    CAPTURE(std::string(row.key));
    const bool list = row.type == SettingType::real_rows;
    if (row.fallback && !list) CHECK(check_value(row, *row.fallback).has_value());
    if (row.type != SettingType::real || row.key == "relief_mm") continue;
    ++judged;
    for (const double value : {row.range.least, row.range.most, row.range.least - 1.0, 2.0 * row.range.most, inf}) {
      SurfaceSettings each;
      row.store(each, SettingValue(value));
      sim::Scene scene = sim::scene_on(hal::ObjectPlane{}, "some", hal::Image(2, 2));
      sim::Surface& surface = each.surface;
      surface.name = "some";
      surface.bands = scene.surfaces[0].bands;
      surface.width_mm = each.width_mm.value_or(1.0);
      surface.height_mm = each.height_mm.value_or(1.0);
      scene.surfaces[0] = surface;
      // Angles may be more than a person would state.
      if (row.range.holds(value)) CHECK(sim::validate(scene).has_value());
      if (value == inf) CHECK_FALSE(sim::validate(scene).has_value());
    }
  }
  CHECK(judged == 12);
  for (const auto& row : scene_settings()) {
    if (row.type != SettingType::real) continue;
    CAPTURE(std::string(row.key));
    for (const double value : {row.range.least, row.range.most, row.range.least - 1.0, row.range.most + 1.0}) {
      SceneFileSettings whole;
      whole.scene = sim::scene_on(hal::ObjectPlane{}, "some", hal::Image(2, 2));
      whole.scene.light.mains_hz = 50.0;
      whole.scene.light.flicker_depth = 0.5;
      if ((row.key == "mains_hz" || row.key == "flicker_depth") && value == 0.0) continue;
      row.store(whole, SettingValue(value));
      CHECK(sim::validate(whole.scene).has_value() == row.range.holds(value));
    }
  }
}

TEST_CASE("the reference documents every key of a scene file as the loader knows it") {
  const std::string reference = text_of(compueye::test::source_path("docs/scene-file.md")) + "\n";
  CHECK_MESSAGE(reference.find(scene_reference()) != std::string::npos, "docs/scene-file.md should hold:\n"
                                                                            << scene_reference());
}
