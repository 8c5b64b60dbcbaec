#include "sim/scene.hpp"

#include <cmath>
#include <string_view>
#include <utility>

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

Result<void> check_length(const Scene& scene, std::string_view what, double value) {
  if (std::isfinite(value) && value > 0.0) return {};
  return fail(ErrorCode::out_of_range, scene.name,
              std::string(what) + " is " + std::to_string(value) + ", expected more than 0 mm");
}

}  // namespace

Scene scene_on(const hal::ObjectPlane& object, std::string name, hal::Image picture) {
  return {std::move(name), std::move(picture), object.width_mm, object.height_mm, std::nullopt};
}

Result<void> validate(const Scene& scene) {
  const hal::Image& picture = scene.picture;
  if (picture.rows < 1 || picture.cols < 1) {
    return fail(ErrorCode::out_of_range, scene.name,
                "the picture is " + std::to_string(picture.rows) + "x" + std::to_string(picture.cols) +
                    " pixels, expected at least 1x1");
  }
  const std::size_t expected = static_cast<std::size_t>(picture.rows) * static_cast<std::size_t>(picture.cols);
  if (picture.pixels.size() != expected) {
    return fail(ErrorCode::mismatch, scene.name,
                "the picture holds " + std::to_string(picture.pixels.size()) + " pixels, expected " +
                    std::to_string(picture.rows) + "x" + std::to_string(picture.cols) + " = " +
                    std::to_string(expected));
  }
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      const float value = picture.at(row, col);
      if (std::isfinite(value) && value >= 0.0F) continue;
      return fail(ErrorCode::out_of_range, scene.name,
                  "pixel (" + std::to_string(row) + ", " + std::to_string(col) + ") is " + std::to_string(value) +
                      ", expected a finite intensity of 0 or more");
    }
  }
  return check_length(scene, "width_mm", scene.width_mm)
      .and_then([&] { return check_length(scene, "height_mm", scene.height_mm); })
      .and_then([&] { return check_length(scene, "distance_mm", scene.distance_mm.value_or(1.0)); });
}

}  // namespace compueye::sim
