#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/settings/document_rules.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::firmware {

/// What a [[surface]] of a scene file says, before its pictures are made.
struct SurfaceSettings {
  sim::Surface surface;  ///< but for its bands, sizes and heights
  std::string picture;   ///< a built-in picture or a PNG
  std::array<int, 2> resolution{640, 640};
  std::uint64_t seed = 0;  ///< of a built-in picture
  std::array<double, 3> colour{1.0, 1.0, 1.0};
  std::optional<double> width_mm, height_mm;
  std::string heights;     ///< of a relief, a picture like the other
  double relief_mm = 0.0;  ///< of its white
};

/// What a scene file says besides its surfaces.
struct SceneFileSettings {
  sim::Scene scene;  ///< but for its surfaces
  std::string description;
  std::optional<std::array<double, 2>> for_plane_mm;  ///< width and distance
};

[[nodiscard]] std::span<const Section> scene_sections();
/// Of [scene], [light] and [display].
[[nodiscard]] std::span<const SettingOf<SceneFileSettings>> scene_settings();
/// Of [[surface]].
[[nodiscard]] std::span<const SettingOf<SurfaceSettings>> surface_settings();
/// Of [effects]: a key for each effect there is, "on" or "off".
[[nodiscard]] std::vector<SettingRule> effect_settings(std::span<const std::string_view> effects);

}  // namespace compueye::firmware
