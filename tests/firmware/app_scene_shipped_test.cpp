#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/scene_choice.hpp"
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

std::string text_of(const fs::path& file) {
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
  const std::string list = text_of(compueye::test::source_path("scenes/README.md"));
  for (const fs::path& file : shipped_scenes()) {
    CAPTURE(file.string());
    const std::string text = text_of(file);
    CHECK((text.starts_with("# Calls for ") || text.starts_with("# Forces ")));
    CHECK(text.find("description = ") != std::string::npos);
    CHECK(list.find("| `" + file.filename().string() + "` |") != std::string::npos);
  }
}
