#include "sim/scene/scene.hpp"

#include <cmath>
#include <utility>

namespace compueye::sim {

bool Scene::still() const noexcept {
  for (const Surface& surface : surfaces) {
    if (!surface.motion.still()) return false;
  }
  return true;
}

double Scene::own_time_s(double start_s) const noexcept {
  return duration_s > 0.0 ? std::fmod(start_s, duration_s) : start_s;
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

}  // namespace compueye::sim
