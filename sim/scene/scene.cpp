#include "sim/scene/scene.hpp"

#include <cmath>
#include <string_view>
#include <utility>

#include "hal/try.hpp"

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

Result<void> check_length(const Surface& surface, std::string_view what, double value) {
  if (std::isfinite(value) && value > 0.0) return {};
  return fail(ErrorCode::out_of_range, surface.name,
              std::string(what) + " is " + std::to_string(value) + ", expected more than 0 mm");
}

Result<void> check_picture(const std::string& name, const hal::Image& picture, float least) {
  if (picture.rows < 1 || picture.cols < 1) {
    return fail(ErrorCode::out_of_range, name,
                "the picture is " + std::to_string(picture.rows) + "x" + std::to_string(picture.cols) +
                    " pixels, expected at least 1x1");
  }
  const std::size_t expected = static_cast<std::size_t>(picture.rows) * static_cast<std::size_t>(picture.cols);
  if (picture.pixels.size() != expected) {
    return fail(ErrorCode::mismatch, name,
                "the picture holds " + std::to_string(picture.pixels.size()) + " pixels, expected " +
                    std::to_string(picture.rows) + "x" + std::to_string(picture.cols) + " = " +
                    std::to_string(expected));
  }
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      const float value = picture.at(row, col);
      if (std::isfinite(value) && value >= least) continue;
      return fail(ErrorCode::out_of_range, name,
                  "pixel (" + std::to_string(row) + ", " + std::to_string(col) + ") is " + std::to_string(value) +
                      ", expected a finite intensity of 0 or more");
    }
  }
  return {};
}

Result<void> check(const Surface& surface) {
  if (surface.bands.size() != 1 && surface.bands.size() != 3) {
    return fail(ErrorCode::out_of_range, surface.name,
                "has " + std::to_string(surface.bands.size()) + " bands, expected 1 or 3");
  }
  for (const hal::Image& band : surface.bands) {
    TRY(check_picture(surface.name, band, 0.0F));
    if (band.rows != surface.picture().rows || band.cols != surface.picture().cols) {
      return fail(ErrorCode::mismatch, surface.name, "has bands of several sizes, expected all alike");
    }
  }
  TRY(check_length(surface, "width_mm", surface.width_mm));
  TRY(check_length(surface, "height_mm", surface.height_mm));
  return check_length(surface, "distance_mm", surface.distance_mm.value_or(1.0));
}

}  // namespace

bool Scene::still() const noexcept {
  for (const Surface& surface : surfaces) {
    if (!surface.motion.still()) return false;
  }
  return true;
}

Scene scene_on(const hal::ObjectPlane& object, std::string name, hal::Image picture) {
  Scene scene;
  scene.name = name;
  Surface& sheet = scene.surfaces.emplace_back();
  sheet.name = std::move(name);
  sheet.bands.push_back(std::move(picture));
  sheet.width_mm = object.width_mm;
  sheet.height_mm = object.height_mm;
  return scene;
}

Scene lit(Scene scene) {
  for (Surface& surface : scene.surfaces) {
    if (surface.shines || scene.light.level == 1.0) continue;
    for (hal::Image& band : surface.bands) {
      for (float& pixel : band.pixels) pixel = static_cast<float>(scene.light.level * static_cast<double>(pixel));
    }
  }
  scene.light.level = 1.0;
  return scene;
}

Result<void> validate(const Scene& scene) {
  if (scene.surfaces.empty()) {
    return fail(ErrorCode::usage, scene.name, "there is nothing to see in it, expected at least one surface");
  }
  for (const Surface& surface : scene.surfaces) TRY(check(surface));
  return {};
}

}  // namespace compueye::sim
