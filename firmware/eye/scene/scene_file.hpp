#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::firmware {

/// Before what a scene file is set up.
struct SceneSite {
  hal::ObjectPlane object;                    ///< where and how large a surface is that does not say
  std::optional<double> distance_mm;          ///< of such surfaces, from the lens tip; absent: the object plane's
  std::span<const std::string_view> effects;  ///< names that [effects] may force
};

/// A scene file, of the sections and keys in docs/scene-file.md, with its pictures.
/// Errors name file, line and value, and what was expected: not_found (no such file, picture, key or effect: the
/// nearest name is told), bad_format (syntax, wrong type, missing key), out_of_range, mismatch (keys that contradict
/// each other or would be ignored), io.
[[nodiscard]] hal::Result<sim::Scene> load_scene(const std::string& file, const SceneSite& site);

/// The same from text; `file` is what errors name, pictures are beside it.
[[nodiscard]] hal::Result<sim::Scene> parse_scene(std::string_view text, const std::string& file,
                                                  const SceneSite& site);

/// What docs/scene-file.md says of each section: its heading, meaning and rows.
[[nodiscard]] std::string scene_reference();

}  // namespace compueye::firmware
