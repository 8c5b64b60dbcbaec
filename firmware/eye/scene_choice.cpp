#include "firmware/eye/scene_choice.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "firmware/files/png.hpp"
#include "hal/try.hpp"
#include "sim/pictures/built_in_scenes.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;

bool is_built_in(const std::string& name) {
  const auto known = sim::built_in_scenes();
  return std::any_of(known.begin(), known.end(), [&](const sim::BuiltInScene& scene) { return scene.name == name; });
}

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

bool looks_like_a_file(const fs::path& path) {
  std::error_code ignored;
  return path.has_extension() || path.has_parent_path() || fs::exists(path, ignored);
}

/// The largest rectangle of the picture's own shape within the plane.
sim::Scene fitted(const hal::ObjectPlane& object, std::string name, hal::Image picture) {
  const double pixel_mm = std::min(object.width_mm / picture.cols, object.height_mm / picture.rows);
  sim::Scene scene = sim::scene_on(object, std::move(name), std::move(picture));
  sim::Surface& sheet = scene.surfaces.front();
  // Not through pixel_mm where a side is filled, so that a picture of the plane's own size stays exactly on its pixels.
  const auto filled = [](double side_mm, double length_mm) {
    return length_mm > side_mm * (1.0 - 1e-12) ? side_mm : length_mm;
  };
  sheet.width_mm = filled(object.width_mm, pixel_mm * sheet.picture().cols);
  sheet.height_mm = filled(object.height_mm, pixel_mm * sheet.picture().rows);
  return scene;
}

hal::Result<sim::Scene> scene_from_file(const hal::ObjectPlane& object, const fs::path& path) {
  return fitted(object, path.stem().string(), TRY(read_png(path)));
}

hal::Result<sim::Scene> built_in_scene(const hal::ObjectPlane& object, const std::string& name, std::uint64_t seed) {
  return sim::scene_on(object, name, TRY(sim::render_built_in(name, object.rows, object.cols, seed)));
}

}  // namespace

hal::Result<sim::Scene> choose_scene(const Board& board, const SceneChoice& choice) {
  const bool from_board = choice.name.empty();
  const std::string name = from_board ? board.scene.name : choice.name;
  if (extension_of(name) == ".toml") {
    return hal::fail(ErrorCode::unsupported, name,
                     "scene files in TOML cannot be read by this version; name a built-in scene or a PNG file");
  }
  std::error_code ignored;
  const fs::path path = from_board ? fs::path(board.folder) / name : fs::path(name);
  const bool file = !is_built_in(name) && (looks_like_a_file(name) || (from_board && fs::exists(path, ignored)));
  auto scene = file ? scene_from_file(board.object, path) : built_in_scene(board.object, name, choice.seed);
  if (!scene) {
    if (from_board && !file) scene.error().place = board.place("scene", "default");
    return scene;
  }
  scene->surfaces.front().distance_mm = choice.distance_mm;
  return scene;
}

std::string built_in_scene_help() {
  std::string text;
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) {
    std::string line = "  " + std::string(scene.name);
    line.resize(std::max<std::size_t>(line.size() + 1, 12), ' ');
    text += line + std::string(scene.description) + "\n";
  }
  return text;
}

}  // namespace compueye::firmware
