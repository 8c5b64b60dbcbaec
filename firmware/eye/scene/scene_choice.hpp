#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/eye/board.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::firmware {

/// Which scene a command line asks for.
struct SceneChoice {
  /// A built-in scene, a PNG or a scene file, or the name of one in shared_folders("scenes"); empty: the board's
  /// default.
  std::string name;
  std::uint64_t seed = 0;             ///< which drawing of a built-in scene
  std::optional<double> distance_mm;  ///< from the lens tip, > 0; absent: on the object plane
};

/// The scene in front of the board's eye. A built-in one has the pixels of the object plane and covers it. A PNG keeps
/// its own pixels, which are taken as square: it is centred and as large as the plane allows, black beyond. A path on
/// the command line is relative to the working folder, one in board.toml to the board's folder.
/// A scene file (.toml) says itself what it shows, whatever the seed. Errors: not_found (no such built-in scene, the
/// nearest is named; no such file), and those of read_png(), render_built_in() and load_scene().
[[nodiscard]] hal::Result<sim::Scene> choose_scene(const Board& board, const SceneChoice& choice);

/// What a perfect reconstruction of the device's frame `frame` shows: sim::scene_truth() in the middle of its exposure.
[[nodiscard]] hal::Result<hal::Image> truth_of_frame(const Board& board, const sim::Scene& scene, std::uint64_t frame);

/// Every built-in scene with its description, a line each, for --help.
[[nodiscard]] std::string built_in_scene_help();

}  // namespace compueye::firmware
