#pragma once

#include <string>
#include <vector>

#include "firmware/eye/scene/scene_settings.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Pixels of all bands and heights of a scene, at most: 256 MiB.
inline constexpr long most_scene_pixels = 1L << 26U;

[[nodiscard]] bool is_built_in(const std::string& picture);
/// Whether the name is meant as a file's: it has an extension or a folder.
[[nodiscard]] bool looks_like_a_file(const std::string& picture);
/// In lower case, with the dot.
[[nodiscard]] std::string extension_of(const std::string& path);

/// The picture of a surface as its bands, times its colour: one where all are alike, else three. Paths are relative to
/// `folder`. Errors: those of read_png_bands() and render_built_in(); their place is the picture.
[[nodiscard]] hal::Result<std::vector<hal::Image>> bands_of(const SurfaceSettings& settings, const std::string& folder);

/// The heights of a relief, mm. Errors: those of read_png() and render_built_in().
[[nodiscard]] hal::Result<hal::Image> heights_of(const SurfaceSettings& settings, const std::string& folder);

/// The largest size of the picture's own shape within the plane.
void fit(const hal::ObjectPlane& object, sim::Surface& surface);

}  // namespace compueye::firmware
