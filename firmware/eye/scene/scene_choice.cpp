#include "firmware/eye/scene/scene_choice.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/eye/scene/scene_file.hpp"
#include "firmware/eye/scene/scene_pictures.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/png.hpp"
#include "firmware/files/shared_folders.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"
#include "sim/effects/effect.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/scene/scene_truth.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

hal::Result<sim::Scene> scene_from_picture(const hal::ObjectPlane& object, const fs::path& path) {
  sim::Scene scene = sim::scene_on(object, path.stem().string(), TRY(read_png(path)));
  fit(object, scene.surfaces.front());
  return scene;
}

std::vector<std::string_view> effect_names() {
  std::vector<std::string_view> names;
  for (const sim::Effect* effect : sim::effects()) names.push_back(effect->name);
  return names;
}

hal::Result<sim::Scene> built_in_scene(const hal::ObjectPlane& object, const std::string& name, std::uint64_t seed) {
  return sim::scene_on(object, name, TRY(sim::render_built_in(name, object.rows, object.cols, seed)));
}

/// A built-in scene, a path, or the machine's scene of this name, with or without ".toml".
std::string scene_meant(const std::string& name) {
  if (is_built_in(name)) return name;
  const std::string found = given_or_shared(name, "scenes");
  if (found != name || !extension_of(name).empty()) return found;
  const std::string file = name + ".toml", shared = given_or_shared(file, "scenes");
  return shared == file ? name : shared;
}

/// The nearest of the machine's scene files, and where they were looked for.
std::string scenes_nearby(const std::string& name) {
  const std::vector<std::string> names = shared_names("scenes");
  const std::vector<std::string_view> views(names.begin(), names.end());
  const auto near = nearest_name(fs::path(name).filename().string(), views);
  return (near ? "; a scene file is called '" + std::string(*near) + "'" : "") +
         shared_folders_searched(name, "scenes");
}

}  // namespace

hal::Result<sim::Scene> choose_scene(const Board& board, const SceneChoice& choice) {
  const bool from_board = choice.name.empty();
  const std::string name = from_board ? board.scene.name : scene_meant(choice.name);
  std::error_code ignored;
  const fs::path path = from_board ? fs::path(board.folder) / name : fs::path(name);
  // What is asked for by name is looked for in more places than its error would name.
  const auto searched = [&](hal::Error error) {
    const bool itself = error.place == path || error.place == "scene";
    if (!from_board && error.code == hal::ErrorCode::not_found && itself) error.sentence += scenes_nearby(choice.name);
    return error;
  };
  if (extension_of(name) == ".toml") {
    if (choice.seed != 0) {
      return hal::fail(hal::ErrorCode::usage, "--scene-seed",
                       "chooses among the drawings of a built-in scene; a scene file has a seed with each picture");
    }
    const std::vector<std::string_view> effects = effect_names();
    return load_scene(path, {board.object, choice.distance_mm, effects}).map_error(searched);
  }
  const bool file = !is_built_in(name) && (looks_like_a_file(name) || fs::exists(path, ignored));
  auto scene = file ? scene_from_picture(board.object, path) : built_in_scene(board.object, name, choice.seed);
  if (!scene) {
    if (from_board && !file) scene.error().place = board.place("scene", "default");
    return std::move(scene).map_error(searched);
  }
  scene->surfaces.front().distance_mm = choice.distance_mm;
  return scene;
}

hal::Result<hal::Image> truth_of_frame(const Board& board, const sim::Scene& scene, std::uint64_t frame) {
  const sim::EyeToSimulate eye = eye_to_simulate(board);
  const double start_s = static_cast<double>(frame) * eye.period_s();
  return sim::scene_truth(scene, board.object, scene.own_time_s(start_s) + eye.integration_s() / 2.0);
}

std::string built_in_scene_help() {
  std::string text;
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) {
    std::string line = "  " + std::string(scene.name);
    line.resize(std::max<std::size_t>(line.size() + 1, 15), ' ');
    text += line + std::string(scene.description) + "\n";
  }
  return text;
}

}  // namespace compueye::firmware
