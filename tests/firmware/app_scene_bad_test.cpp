#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/files/png.hpp"
#include "tests/firmware/app_board_text.hpp"
#include "tests/firmware/app_scene_text.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

// What is wrong with a scene file is told in one sentence, with file and line.

using namespace compueye;
using namespace compueye::firmware;
using firmware::test::good_scene;
using firmware::test::some_site;
using hal::ErrorCode;

namespace {

/// The good scene with `old` replaced by `with`, and what the error must be.
struct BadScene {
  std::string_view old, with;
  int line;
  compueye::test::Named named;
  ErrorCode code;
};

void check_all(std::initializer_list<BadScene> cases) {
  for (const BadScene& bad : cases) {
    CAPTURE(bad.old);
    CAPTURE(bad.with);
    const std::string text = firmware::test::replaced(good_scene, bad.old, bad.with);
    REQUIRE_FALSE(text.empty());
    compueye::test::check_error(parse_scene(text, "s/scene.toml", some_site()), bad.code,
                                bad.line > 0 ? "s/scene.toml:" + std::to_string(bad.line) : "s/scene.toml", bad.named);
  }
}

}  // namespace

TEST_CASE("unknown keys, sections and effects of a scene are errors with the nearest name") {
  check_all({
      {"duration_s", "duration", 2, {"duration", "duration_s?"}, ErrorCode::not_found},
      {"tilt_deg", "tilt", 15, {"tilt", "[surface]"}, ErrorCode::not_found},
      {"gamma = 2.2", "level = 2.2", 6, {"level", "[display]", "[light]"}, ErrorCode::not_found},
      {"[light]", "[lite]", 3, {"lite"}, ErrorCode::not_found},
      {"motion = \"on\"", "motoin = \"on\"", 8, {"motoin", "motion?"}, ErrorCode::not_found},
      {"motion = \"on\"", "motion = true", 8, {"motion", "true"}, ErrorCode::bad_format},
      {"motion = \"on\"", "motion = \"auto\"", 8, {"motion", "auto"}, ErrorCode::not_found},
      {"motion = \"on\"", "motion = \"on\"\nmotion = \"off\"", 9, {"motion"}, ErrorCode::bad_format},
      {"[[surface]]\nname", "[surface]\nname", 17, {}, ErrorCode::bad_format},
      {"[light]", "[[light]]", 3, {"light"}, ErrorCode::bad_format},
      {"picture = \"star\"\n", "", 9, {"picture", "[surface]"}, ErrorCode::bad_format},
      {"picture = \"white\"\n", "", 17, {"picture"}, ErrorCode::bad_format},
  });
  compueye::test::check_error(parse_scene("surface = 3\n", "s/scene.toml", some_site()), ErrorCode::bad_format,
                              "s/scene.toml:1", {"surface", "3"});
  compueye::test::check_error(parse_scene("", "s/scene.toml", some_site()), ErrorCode::bad_format, "s/scene.toml",
                              {"surface", "picture"});
}

TEST_CASE("values of a scene out of type or range are told with what was expected") {
  check_all({
      {"distance_mm = 25", "distance_mm = 0", 14, {"distance_mm", "0"}, ErrorCode::out_of_range},
      {"distance_mm = 25", "distance_mm = -3", 14, {"distance_mm", "-3"}, ErrorCode::out_of_range},
      {"distance_mm = 25", "distance_mm = nan", 14, {"distance_mm", "nan"}, ErrorCode::out_of_range},
      {"width_mm = 6", "width_mm = 0", 13, {"width_mm", "0"}, ErrorCode::out_of_range},
      {"width_mm = 6", "width_mm = 1e7", 13, {"width_mm", "1e7", "1000000"}, ErrorCode::out_of_range},
      {"duration_s = 5", "duration_s = -5", 2, {"duration_s", "-5"}, ErrorCode::out_of_range},
      {"level = 2", "level = -2", 4, {"level", "-2"}, ErrorCode::out_of_range},
      {"level = 2", "mains_hz = 20", 4, {"mains_hz", "20", "40", "500"}, ErrorCode::out_of_range},
      {"level = 2", "flicker_depth = 0.5", 4, {"flicker_depth", "mains_hz"}, ErrorCode::mismatch},
      {"level = 2", "spectrum = [0, 0, 0]", 4, {"spectrum", "0"}, ErrorCode::out_of_range},
      {"gamma = 2.2", "refresh_hz = -60", 6, {"refresh_hz", "-60"}, ErrorCode::out_of_range},
      {"[1, -2, 0.5]", "[1, -2]", 16, {"velocity_mm_per_s", "[x, y, z]", "[1, -2]"}, ErrorCode::bad_format},
      {"[1, -2, 0.5]", "[1, nan, 0]", 16, {"velocity_mm_per_s", "nan"}, ErrorCode::out_of_range},
      {"[1, -2, 0.5]", "3", 16, {"velocity_mm_per_s", "3"}, ErrorCode::bad_format},
      {"[[1, 0, 0, 5], [2, 3, 0, 0]]", "[[1, 0, 0]]", 22, {"path", "[t, x, y, z]"}, ErrorCode::bad_format},
      {"[[1, 0, 0, 5], [2, 3, 0, 0]]", "[1, 0, 0, 5]", 22, {"path"}, ErrorCode::bad_format},
      {"[[1, 0, 0, 5], [2, 3, 0, 0]]", "[[1, 0, 0, 5], [1, 3, 0, 0]]", 22, {"path", "1"}, ErrorCode::mismatch},
      {"[[1, 0, 0, 5], [2, 3, 0, 0]]", "[[-1, 0, 0, 5]]", 22, {"path", "-1"}, ErrorCode::out_of_range},
      {"[[1, 0, 0, 5], [2, 3, 0, 0]]", "[[0, 0, 0, 5]]", 22, {"path"}, ErrorCode::mismatch},
      {"[[1, 0, 0, 5], [2, 3, 0, 0]]", "[[1, 0, inf, 5]]", 22, {"path", "inf"}, ErrorCode::out_of_range},
      {"repeats = true", "repeats = 1", 23, {"repeats", "true", "false"}, ErrorCode::bad_format},
      {"[32, 64]", "[32, 64.5]", 12, {"resolution", "64.5"}, ErrorCode::bad_format},
      {"[32, 64]", "[32, 5000]", 12, {"resolution", "5000", "4096"}, ErrorCode::out_of_range},
      {"[32, 64]", "[0, 64]", 12, {"resolution", "0"}, ErrorCode::out_of_range},
  });
}

TEST_CASE("keys of a scene that contradict each other or would be ignored are refused") {
  check_all({
      {"motion = \"on\"", "motion = \"off\"\nmotion_blur = \"on\"", 9, {"motion_blur", "motion"}, ErrorCode::mismatch},
      {"tilt_deg = 30", "relief_mm = 3", 15, {"relief_mm", "relief"}, ErrorCode::mismatch},
      {"tilt_deg = 30", "heights = \"star\"", 15, {"heights", "relief"}, ErrorCode::mismatch},
      {"tilt_deg = 30", "shape = \"relief\"", 15, {"heights", "relief"}, ErrorCode::bad_format},
      {"tilt_deg = 30", "shape = \"relief\"\nheights = \"star\"", 15, {"relief_mm"}, ErrorCode::bad_format},
      {"tilt_deg = 30", "shape = \"sphere\"\nheight_mm = 3", 16, {"height_mm", "sphere"}, ErrorCode::mismatch},
      {"velocity_mm_per_s = [1, -2, 0.5]", "start_s = 1", 16, {"start_s", "motion"}, ErrorCode::mismatch},
      {"velocity_mm_per_s = [1, -2, 0.5]",
       "velocity_mm_per_s = [1, -2, 0.5]\nstart_s = 5",
       17,
       {"start_s", "5", "never"},
       ErrorCode::mismatch},
      {"level = 2", "mains_hz = 50", 4, {"mains_hz", "flicker_depth"}, ErrorCode::mismatch},
      {"path = [[1, 0, 0, 5], [2, 3, 0, 0]]\n", "", 22, {"repeats", "path"}, ErrorCode::mismatch},
      {"shines = true\n", "", 5, {"[display]", "shines"}, ErrorCode::mismatch},
      {"tilt_deg = 30", "shines = true", 3, {"[light]"}, ErrorCode::mismatch},
      {"picture = \"white\"", "name = \"card\"\npicture = \"white\"", 18, {"card"}, ErrorCode::mismatch},
  });
}

TEST_CASE("what is a part of an effect cannot be on without it, of the effects that there are") {
  const compueye::test::TemporaryFolder folder;
  const Board board = parse_board(firmware::test::good_board, "board.toml").value();
  const std::string file = (folder / "scene.toml").string();
  for (const std::string part : {"motion_blur", "sampling_skew", "display_refresh"}) {
    std::ofstream(file) << "[[surface]]\npicture = \"star\"\n[effects]\nmotion = \"off\"\n" << part << " = \"on\"\n";
    compueye::test::check_error(choose_scene(board, {file, 0, std::nullopt}), ErrorCode::mismatch, file + ":5",
                                {part, "motion"});
  }
}

TEST_CASE("what is or comes inside the eye, or leaves numbers, is told with the time and the line that moves it") {
  check_all({
      // A corner 3 mm sideways at 30 degrees is 1.5 mm nearer.
      {"distance_mm = 25\ntilt_deg = 30\nvelocity_mm_per_s = [1, -2, 0.5]",
       "distance_mm = 1.4\ntilt_deg = 30",
       14,
       {"card", "0"},
       ErrorCode::out_of_range},
      {"[1, -2, 0.5]", "[0, 0, -6]", 16, {"card", "3.916667", "-6.5"}, ErrorCode::out_of_range},
      {"[1, -2, 0.5]", "[0, 3e5, 0]", 16, {"card", "1000000", "duration_s"}, ErrorCode::out_of_range},
      {"[1, 0, 0, 5]", "[1, 0, 0, -31]", 22, {"2", "-1"}, ErrorCode::out_of_range},
  });
}

TEST_CASE("a picture that cannot be had is told at the line that names it") {
  const compueye::test::TemporaryFolder folder;
  std::ofstream(folder / "text.png") << "no picture at all";
  const auto refused = [&](const std::string& keys, ErrorCode code, const compueye::test::Named& named, int line = 2) {
    CAPTURE(keys);
    const std::string file = (folder / "scene.toml").string();
    std::ofstream(file) << "[[surface]]\n" << keys;
    compueye::test::check_error(load_scene(file, some_site()), code, file + ":" + std::to_string(line), named);
  };
  refused("picture = \"gone.png\"\n", ErrorCode::not_found, {"gone.png"});
  refused("picture = \"no/where\"\n", ErrorCode::not_found, {"no/where"});
  refused("picture = \"text.png\"\n", ErrorCode::bad_format, {"text.png"});
  refused("picture = \"txt\"\n", ErrorCode::not_found, {"txt", "text?"});
  refused("picture = \"\"\n", ErrorCode::not_found, {"picture"});
  refused("picture = \"fig2\"\nresolution = [8, 8]\n", ErrorCode::out_of_range, {"8x8", "16x16"});
  refused("picture = \"star\"\nshape = \"relief\"\nrelief_mm = 1\nheights = \"h.png\"\n", ErrorCode::not_found,
          {"h.png", "heights"}, 5);
  REQUIRE(write_png(folder / "good.png", hal::Image(2, 2, 0.5F)).has_value());
  refused("picture = \"good.png\"\nresolution = [8, 8]\n", ErrorCode::mismatch, {"resolution"}, 3);
  compueye::test::check_error(load_scene(folder / "none.toml", some_site()), ErrorCode::not_found,
                              (folder / "none.toml").string(), {});
}

TEST_CASE("a scene of too many pixels is refused with the limit") {
  if (compueye::test::sanitized) return;
  // Four bands of 4096 x 4096 are the limit, and one row more is too much.
  const std::string three = "[[surface]]\npicture = \"white\"\nresolution = [4096, 4096]\ncolour = [1, 0, 0]\n";
  compueye::test::check_error(parse_scene(three + "[[surface]]\npicture = \"white\"\nresolution = [4096, 4096]\n"
                                                  "[[surface]]\npicture = \"white\"\nresolution = [1, 1]\n",
                                          "scene.toml", some_site()),
                              ErrorCode::out_of_range, "scene.toml:9", {"67108864", "67108865"});
}

TEST_CASE("any mutation of a scene gives a scene or an error with a place") {
  std::mt19937 random(20160218);
  const std::string sharp = "[]{}=.,\"'#\n\\-0123456789einfxyz ";
  int good = 0;
  const int rounds = compueye::test::sanitized ? 200 : 1500;
  for (int round = 0; round < rounds; ++round) {
    std::string text = good_scene;
    for (std::size_t m = 1 + random() % 4; m > 0 && !text.empty(); --m) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0) {
        text.erase(at, 1 + random() % 5);
      } else {
        text[at] = sharp[random() % sharp.size()];
      }
    }
    CAPTURE(text);
    const auto scene = parse_scene(text, "scene.toml", some_site());
    good += scene.has_value() ? 1 : 0;
    if (scene) CHECK(sim::validate(*scene).has_value());
    if (!scene) CHECK(scene.error().place.starts_with("scene.toml"));
  }
  CHECK(good > 0);
  CHECK(good < rounds);
}
