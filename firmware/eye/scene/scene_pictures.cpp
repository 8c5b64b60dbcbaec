#include "firmware/eye/scene/scene_pictures.hpp"

#include <algorithm>
#include <filesystem>

#include "firmware/files/png.hpp"
#include "hal/try.hpp"
#include "sim/pictures/built_in_scenes.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::Result;

Result<std::vector<hal::Image>> read_or_drawn(const std::string& name, const SurfaceSettings& settings,
                                              const std::string& folder) {
  const auto placed = [&](hal::Error error) {
    error.place = name;
    return error;
  };
  if (looks_like_a_file(name) && !is_built_in(name)) {
    return read_png_bands((fs::path(folder) / name).string()).map_error(placed);
  }
  const auto [rows, cols] = settings.resolution;
  std::vector<hal::Image> bands;
  bands.push_back(TRY(sim::render_built_in(name, rows, cols, settings.seed).map_error(placed)));
  return bands;
}

void scale(hal::Image& band, double factor) {
  if (factor == 1.0) return;
  for (float& pixel : band.pixels) pixel = static_cast<float>(static_cast<double>(pixel) * factor);
}

}  // namespace

bool is_built_in(const std::string& picture) {
  const auto known = sim::built_in_scenes();
  return std::any_of(known.begin(), known.end(), [&](const auto& scene) { return scene.name == picture; });
}

bool looks_like_a_file(const std::string& picture) {
  const fs::path path = picture;
  return path.has_extension() || path.has_parent_path();
}

std::string extension_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

Result<std::vector<hal::Image>> bands_of(const SurfaceSettings& settings, const std::string& folder) {
  std::vector<hal::Image> bands = TRY(read_or_drawn(settings.picture, settings, folder));
  const auto& colour = settings.colour;
  const bool grey = colour[0] == colour[1] && colour[1] == colour[2];
  if (bands.size() == 1 && !grey) bands.resize(3, bands.front());
  for (std::size_t band = 0; band < bands.size(); ++band) scale(bands[band], colour[band]);
  return bands;
}

Result<hal::Image> heights_of(const SurfaceSettings& settings, const std::string& folder) {
  std::vector<hal::Image> bands = TRY(read_or_drawn(settings.heights, settings, folder));
  hal::Image heights = std::move(bands.front());
  scale(heights, settings.relief_mm);
  return heights;
}

void fit(const hal::ObjectPlane& object, sim::Surface& surface) {
  const hal::Image& picture = surface.picture();
  const double pixel_mm = std::min(object.width_mm / picture.cols, object.height_mm / picture.rows);
  // Not through pixel_mm where a side is filled, so that a picture of the plane's own size stays exactly on its pixels.
  const auto filled = [](double side_mm, double length_mm) {
    return length_mm > side_mm * (1.0 - 1e-12) ? side_mm : length_mm;
  };
  surface.width_mm = filled(object.width_mm, pixel_mm * picture.cols);
  surface.height_mm = filled(object.height_mm, pixel_mm * picture.rows);
}

}  // namespace compueye::firmware
