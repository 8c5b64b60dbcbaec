#include "firmware/eye/scene/scene_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace compueye::firmware {

ScenePlaces::ScenePlaces(std::string file, TomlDocument document)
    : file_(std::move(file)), document_(std::move(document)) {}

const TomlEntry* ScenePlaces::entry(std::string_view section, std::string_view key, int number) const noexcept {
  for (const TomlEntry& each : document_.entries) {
    if (each.section == section && each.key == key && each.number == number) return &each;
  }
  return nullptr;
}

int ScenePlaces::surfaces() const noexcept {
  return static_cast<int>(std::count_if(document_.sections.begin(), document_.sections.end(),
                                        [](const TomlSection& section) { return section.name == "surface"; }));
}

bool ScenePlaces::has(std::string_view section) const noexcept {
  return std::any_of(document_.sections.begin(), document_.sections.end(),
                     [&](const TomlSection& each) { return each.name == section; });
}

bool ScenePlaces::states(std::string_view section, std::string_view key, int number) const noexcept {
  return entry(section, key, number) != nullptr;
}

std::string ScenePlaces::of(std::string_view section, std::string_view key, int number) const {
  if (const TomlEntry* stated = entry(section, key, number)) return fmt::format("{}:{}", file_, stated->line);
  for (const TomlSection& each : document_.sections) {
    if (each.name == section && each.number == number) return fmt::format("{}:{}", file_, each.line);
  }
  return file_;
}

hal::Error ScenePlaces::placed(hal::Error error, const sim::Scene& scene) const {
  const auto at = std::find_if(scene.surfaces.begin(), scene.surfaces.end(),
                               [&](const sim::Surface& surface) { return surface.name == error.place; });
  const bool of_surface = at != scene.surfaces.end();
  const int number = static_cast<int>(at - scene.surfaces.begin());
  std::string line;
  for (const TomlEntry& each : document_.entries) {
    const bool there = of_surface ? each.section == "surface" && each.number == number : each.section != "surface";
    if (there && each.key != "name" && error.sentence.find(each.key) != std::string::npos) {
      line = of(each.section, each.key, each.number);
      break;
    }
  }
  for (const std::string_view key : {"path", "velocity_mm_per_s", "distance_mm"}) {
    if (line.empty() && of_surface && states("surface", key, number)) line = of("surface", key, number);
  }
  if (line.empty()) line = of_surface ? of("surface", "name", number) : of("scene", "duration_s");
  if (of_surface) error.sentence = fmt::format("'{}' {}", error.place, error.sentence);
  error.place = line;
  return error;
}

}  // namespace compueye::firmware
