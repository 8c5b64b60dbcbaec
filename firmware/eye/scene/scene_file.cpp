#include "firmware/eye/scene/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "firmware/eye/scene/scene_pictures.hpp"
#include "firmware/eye/scene/scene_places.hpp"
#include "firmware/eye/scene/scene_settings.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::Result;

/// The defaults and what the file says of one section, or of all of a target's.
template <class Target>
void store(std::span<const SettingOf<Target>> rows, const TomlDocument& document, int number, Target& target) {
  for (const SettingOf<Target>& row : rows) {
    if (row.fallback) row.store(target, *row.fallback);
  }
  for (const TomlEntry& entry : document.entries) {
    if (entry.number != number) continue;
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const SettingOf<Target>& each) {
      return each.section == entry.section && each.key == entry.key;
    });
    if (row != rows.end()) row->store(target, entry.value);
  }
}

/// A key that would be ignored, and what it needs not to be.
struct Need {
  std::string_view key;
  bool met;
  std::string_view other;
};

Result<void> check_needs(const SurfaceSettings& s, int number, const ScenePlaces& places) {
  const bool relief = s.surface.shape == sim::Shape::relief;
  const bool drawn = is_built_in(s.picture) || is_built_in(s.heights);
  for (const Need& need :
       {Need{"heights", relief, "shape = \"relief\""}, Need{"relief_mm", relief, "shape = \"relief\""},
        Need{"resolution", drawn, "a built-in picture"}, Need{"seed", drawn, "a built-in picture"},
        Need{"height_mm", s.surface.shape != sim::Shape::sphere, "another shape than a sphere"},
        Need{"repeats", !s.surface.motion.path.empty(), "a path"},
        Need{"start_s", !s.surface.motion.still(), "a motion"}}) {
    if (need.met || !places.states("surface", need.key, number)) continue;
    return hal::fail(
        ErrorCode::mismatch, places.of("surface", need.key, number),
        fmt::format("{} means nothing in [[surface]] without {}; state that or remove the line", need.key, need.other));
  }
  for (const std::string_view key : {"heights", "relief_mm"}) {
    if (!relief || places.states("surface", key, number)) continue;
    return hal::fail(ErrorCode::bad_format, places.of("surface", "shape", number),
                     fmt::format("key '{}' is missing in [[surface]], a relief needs it", key));
  }
  return {};
}

Result<void> check_names(const std::vector<SurfaceSettings>& surfaces, const ScenePlaces& places) {
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    for (std::size_t before = 0; before < n; ++before) {
      if (surfaces[n].surface.name != surfaces[before].surface.name) continue;
      return hal::fail(ErrorCode::mismatch, places.of("surface", "name", static_cast<int>(n)),
                       fmt::format("'{}' names a second surface in [[surface]], expected another name for each",
                                   excerpt(surfaces[n].surface.name)));
    }
  }
  return {};
}

/// Light and display need something to be for.
Result<void> check_sections(const std::vector<SurfaceSettings>& surfaces, const ScenePlaces& places) {
  const auto shines = [](const SurfaceSettings& s) { return s.surface.shines; };
  if (places.has("display") && std::none_of(surfaces.begin(), surfaces.end(), shines)) {
    return hal::fail(ErrorCode::mismatch, places.of("display", ""),
                     "[display] means nothing without a surface with shines = true; state that or remove the section");
  }
  if (places.has("light") && std::all_of(surfaces.begin(), surfaces.end(), shines)) {
    return hal::fail(ErrorCode::mismatch, places.of("light", ""),
                     "[light] means nothing where every surface shines; remove the section");
  }
  return {};
}

/// An effect that is nothing but a part of another one.
struct Part {
  std::string_view effect, whole;
};
constexpr std::array<Part, 3> parts{
    {{"motion_blur", "motion"}, {"sampling_skew", "motion"}, {"display_refresh", "motion"}}};

Result<void> store_effects(const ScenePlaces& places, sim::Scene& scene) {
  for (const TomlEntry& entry : places.document().entries) {
    if (entry.section != "effects") continue;
    const bool on = std::get<std::string>(entry.value) == "on";
    scene.effects.emplace(entry.key, on ? sim::Forced::on : sim::Forced::off);
  }
  const auto is = [&](std::string_view effect, sim::Forced how) {
    const auto at = scene.effects.find(std::string(effect));
    return at != scene.effects.end() && at->second == how;
  };
  for (const Part& part : parts) {
    if (!is(part.effect, sim::Forced::on) || !is(part.whole, sim::Forced::off)) continue;
    return hal::fail(ErrorCode::mismatch, places.of("effects", part.effect),
                     fmt::format("{} = \"on\" contradicts {} = \"off\" in [effects], of which it is a part",
                                 part.effect, part.whole));
  }
  return {};
}

/// Lengths across and along z, times these.
struct Scales {
  double across = 1.0, along = 1.0;

  static Scales of(const SceneFileSettings& whole, const hal::ObjectPlane& object) {
    if (!whole.for_plane_mm) return {};
    const auto& [width_mm, distance_mm] = *whole.for_plane_mm;
    return {object.width_mm / width_mm, object.distance_mm / distance_mm};
  }
  [[nodiscard]] hal::Vec3 scaled(const hal::Vec3& v) const noexcept {
    return {across * v.x, across * v.y, along * v.z};
  }
  void scale(SurfaceSettings& s) const {
    if (s.width_mm) *s.width_mm *= across;
    if (s.height_mm) *s.height_mm *= across;
    if (s.surface.distance_mm) *s.surface.distance_mm *= along;
    s.relief_mm *= along;
    s.surface.pose.centre_mm = scaled(s.surface.pose.centre_mm);
    s.surface.motion.velocity_mm_per_s = scaled(s.surface.motion.velocity_mm_per_s);
    for (sim::Waypoint& waypoint : s.surface.motion.path) waypoint.offset_mm = scaled(waypoint.offset_mm);
  }
};

Result<std::vector<SurfaceSettings>> surfaces_of(const ScenePlaces& places, const Scales& scales) {
  std::vector<SurfaceSettings> surfaces(static_cast<std::size_t>(places.surfaces()));
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    SurfaceSettings& each = surfaces[n];
    each.surface.name = fmt::format("surface {}", n + 1);
    store(surface_settings(), places.document(), static_cast<int>(n), each);
    TRY(check_needs(each, static_cast<int>(n), places));
    scales.scale(each);
  }
  TRY(check_names(surfaces, places));
  TRY(check_sections(surfaces, places));
  return surfaces;
}

void set_size(const SurfaceSettings& settings, const hal::ObjectPlane& object, sim::Surface& surface) {
  const double shape = static_cast<double>(surface.picture().rows) / surface.picture().cols;
  fit(object, surface);
  const bool sphere = surface.shape == sim::Shape::sphere;
  if (sphere) surface.width_mm = surface.height_mm = std::min(surface.width_mm, surface.height_mm);
  if (settings.width_mm) {
    surface.width_mm = *settings.width_mm;
    surface.height_mm = sphere ? surface.width_mm : shape * surface.width_mm;
  }
  if (!settings.height_mm) return;
  surface.height_mm = *settings.height_mm;
  if (!settings.width_mm) surface.width_mm = surface.height_mm / shape;
}

/// What is wrong with a picture, said of the line that names it.
auto at_key(const ScenePlaces& places, std::string_view key, int number) {
  return [&places, key, number](hal::Error error) {
    error.sentence = fmt::format("{} = \"{}\" in [[surface]]: {}", key, excerpt(error.place), error.sentence);
    error.place = places.of("surface", key, number);
    return error;
  };
}

Result<sim::Surface> made(const SurfaceSettings& settings, int number, const ScenePlaces& places,
                          const SceneSite& site) {
  const std::string folder = fs::path(places.file()).parent_path().string();
  sim::Surface surface = settings.surface;
  surface.bands = TRY(bands_of(settings, folder).map_error(at_key(places, "picture", number)));
  if (surface.shape == sim::Shape::relief) {
    surface.heights = TRY(heights_of(settings, folder).map_error(at_key(places, "heights", number)));
  }
  set_size(settings, site.object, surface);
  if (!surface.distance_mm) surface.distance_mm = site.distance_mm;
  return surface;
}

long pixels_of(const sim::Surface& surface) noexcept {
  auto pixels = surface.heights.pixels.size();
  for (const hal::Image& band : surface.bands) pixels += band.pixels.size();
  return static_cast<long>(pixels);
}

Result<void> make_surfaces(const std::vector<SurfaceSettings>& surfaces, const ScenePlaces& places,
                           const SceneSite& site, sim::Scene& scene) {
  long pixels = 0;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const int number = static_cast<int>(n);
    scene.surfaces.push_back(TRY(made(surfaces[n], number, places, site)));
    pixels += pixels_of(scene.surfaces.back());
    if (pixels <= most_scene_pixels) continue;
    return hal::fail(ErrorCode::out_of_range, places.of("surface", "picture", number),
                     fmt::format("picture in [[surface]] makes the scene {} pixels large, bands counted each, expected "
                                 "at most {} in all",
                                 pixels, most_scene_pixels));
  }
  const bool all_far = std::all_of(surfaces.begin(), surfaces.end(),
                                   [](const SurfaceSettings& s) { return s.surface.distance_mm.has_value(); });
  if (site.distance_mm && all_far) {
    return hal::fail(ErrorCode::mismatch, places.file(),
                     "says distance_mm of every surface, which leaves none for --scene-distance to move");
  }
  return {};
}

std::string heading(const Section& section) {
  return section.repeats ? fmt::format("[[{}]]", section.name) : fmt::format("[{}]", section.name);
}

template <class Rows>
void add_rules(const Rows& rows, std::vector<const SettingRule*>& rules) {
  for (const SettingRule& row : rows) rules.push_back(&row);
}

}  // namespace

Result<sim::Scene> parse_scene(std::string_view text, const std::string& file, const SceneSite& site) {
  const std::vector<SettingRule> forced = effect_settings(site.effects);
  DocumentRules rules{scene_sections(), {}};
  add_rules(scene_settings(), rules.keys);
  add_rules(surface_settings(), rules.keys);
  add_rules(forced, rules.keys);
  const ScenePlaces places(file, TRY(parse_toml(text, file)));
  TRY(check_document(places.document(), rules, file));

  SceneFileSettings whole;
  whole.scene.name = fs::path(file).stem().string();
  store(scene_settings(), places.document(), 0, whole);
  sim::Scene& scene = whole.scene;
  TRY(store_effects(places, scene));
  const std::vector<SurfaceSettings> surfaces = TRY(surfaces_of(places, Scales::of(whole, site.object)));
  TRY(make_surfaces(surfaces, places, site, scene));
  const auto placed = [&](const hal::Error& error) { return places.placed(error, scene); };
  TRY(sim::validate(scene).map_error(placed));
  TRY(sim::validate_travel(scene, site.distance_mm.value_or(site.object.distance_mm)).map_error(placed));
  return std::move(whole.scene);
}

Result<sim::Scene> load_scene(const std::string& file, const SceneSite& site) {
  constexpr std::uint64_t largest_file = 1U << 20U;
  return parse_scene(TRY(read_whole_file(file, largest_file)), file, site);
}

std::string scene_reference() {
  std::vector<const SettingRule*> all;
  add_rules(scene_settings(), all);
  add_rules(surface_settings(), all);
  std::string text;
  for (const Section& section : scene_sections()) {
    std::vector<const SettingRule*> rules;
    std::copy_if(all.begin(), all.end(), std::back_inserter(rules),
                 [&](const SettingRule* rule) { return rule->section == section.name; });
    text += fmt::format("## {}\n{}\n\n", heading(section), section.meaning);
    if (!rules.empty()) text += reference_table(rules) + "\n";
  }
  return text;
}

}  // namespace compueye::firmware
