#include "firmware/eye/scene/scene_settings.hpp"

#include <numbers>

#include "firmware/eye/settings/field.hpp"

namespace compueye::firmware {
namespace {

using sim::Display;
using sim::Light;
using sim::Motion;
using sim::Pose;
using sim::Scene;
using sim::Shape;
using sim::Surface;
using V = SettingValue;
using Whole = SceneFileSettings;
using Each = SurfaceSettings;

// Ranges are those of sim::validate(); a test holds them together.
constexpr Range length_mm{1e-6, sim::farthest_mm};
constexpr Range place_mm{-sim::farthest_mm, sim::farthest_mm};
constexpr Range seconds{0.0, sim::longest_scene_s};
constexpr Range angle_deg{-360.0, 360.0};
constexpr Range rate_deg{-36000.0, 36000.0};
constexpr double deg = std::numbers::pi / 180.0;

constexpr std::array<Section, 5> all_sections{{
    {"scene", "What the scene is called and how long it goes on."},
    {"light", "What lights the surfaces that do not shine by themselves."},
    {"display", "What a display does to the pictures of the surfaces that shine."},
    {"effects", "What is not to be left to the planner: which effects are simulated in any case, and which in none."},
    {"surface", "Something to see, as many as wanted.", true},
}};

std::span<const recon::Named<Shape>> shapes() {
  static constexpr std::array<recon::Named<Shape>, 3> names{
      {{"plane", Shape::plane}, {"sphere", Shape::sphere}, {"relief", Shape::relief}}};
  return names;
}

/// Degrees in the file, radians in the surface.
template <auto... Path>
RowOf<Each> degrees(std::string_view name, std::string_view meaning) {
  return RowOf<Each>(name, meaning)
      .of(SettingType::real)
      .stored([](Each& each, const V& v) { member_of<&Each::surface, Path...>(each) = real_of(v) * deg; },
              [](const Each& each) { return value_of(member_of<&Each::surface, Path...>(each) / deg); })
      .otherwise(V{0.0});
}

void store_resolution(Each& each, const V& v) {
  const auto& sides = std::get<std::vector<std::int64_t>>(v);
  each.resolution = {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}
std::optional<V> resolution_of(const Each& each) {
  return V{std::vector<std::int64_t>{each.resolution[0], each.resolution[1]}};
}

/// A path begins at the surface's own place, unless its first row says otherwise for t = 0.
void store_path(Each& each, const V& v) {
  std::vector<sim::Waypoint>& path = each.surface.motion.path;
  path.clear();
  const auto* rows = std::get_if<NumberRows>(&v);
  if (rows == nullptr) return;
  for (const std::vector<double>& row : *rows) {
    if (path.empty() && row[0] > 0.0) path.push_back({});
    path.push_back({row[0], {row[1], row[2], row[3]}});
  }
}
std::optional<V> path_of(const Each& each) {
  NumberRows rows;
  for (const sim::Waypoint& w : each.surface.motion.path) {
    rows.push_back({w.t_s, w.offset_mm.x, w.offset_mm.y, w.offset_mm.z});
  }
  return V{rows};
}

std::vector<SettingOf<Whole>> make_scene_settings() {
  std::vector<SettingOf<Whole>> all;
  add<Whole>(
      all, "scene",
      {field<&Whole::scene, &Scene::name>("name", "in reports and file names; left out, the file's own")
           .of(SettingType::identifier),
       field<&Whole::description>("description", "one sentence for people").otherwise(""),
       RowOf<Whole>("for_plane_mm",
                    "the object plane that this file is for: before another one, lengths across are scaled by its "
                    "width and those along z by its distance; left out, they are as they are")
           .of(SettingType::real_tuple)
           .as("[width, distance]")
           .within(length_mm)
           .stored([](Whole& whole, const V& v) { whole.for_plane_mm = pair_of(v); },
                   [](const Whole&) -> std::optional<V> { return std::nullopt; }),
       field<&Whole::scene, &Scene::duration_s>(
           "duration_s", "after which it begins anew, but for lamps and sensors; 0: it goes on for ever")
           .within(seconds)
           .otherwise(V{0.0})});
  add<Whole>(
      all, "light",
      {field<&Whole::scene, &Scene::light, &Light::level>("level", "of light; 1: a white picture reads as white")
           .within({0, 1000})
           .otherwise(V{1.0}),
       field<&Whole::scene, &Scene::light, &Light::falloff>(
           "falloff", "share lost at the object plane's corner, as the square of the distance from its middle")
           .within({0, 1})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::light, &Light::drift_per_hour>("drift_per_hour", "relative change, linear in time")
           .within({-1, 10})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::light, &Light::mains_hz>(
           "mains_hz", "of a lamp that flickers at twice that, from 40 on; 0: one that does not")
           .within({0, 500})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::light, &Light::flicker_depth>("flicker_depth",
                                                                  "amplitude of the flicker; goes with mains_hz")
           .within({0, 1})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::light, &Light::spectrum>("spectrum", "of the light in the three bands, not all 0")
           .as("[red, green, blue]")
           .within({0, 1e6})
           .otherwise(V{std::vector<double>{1.0, 1.0, 1.0}})});
  add<Whole>(
      all, "display",
      {field<&Whole::scene, &Scene::display, &Display::gamma>(
           "gamma", "what is shown is black_level + (1 - black_level) picture^gamma")
           .within({0.2, 5})
           .otherwise(V{1.0}),
       field<&Whole::scene, &Scene::display, &Display::black_level>("black_level", "light where the picture is black")
           .within({0, 0.9})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::display, &Display::refresh_hz>(
           "refresh_hz", "what moves on it moves in so many steps a second; 0: smoothly")
           .within({0, 1e6})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::display, &Display::drift_per_hour>("drift_per_hour",
                                                                       "relative change of its light, linear in time")
           .within({-1, 10})
           .otherwise(V{0.0}),
       field<&Whole::scene, &Scene::display, &Display::pixel_blur>(
           "pixel_blur", "share of a pixel's width over which it runs into its neighbour")
           .within({0, 1})
           .otherwise(V{0.0})});
  return all;
}

void add_looks(std::vector<SettingOf<Each>>& all) {
  add<Each>(
      all, "surface",
      {field<&Each::surface, &Surface::name>("name", "as errors name it; left out, \"surface 1\" and so on"),
       field<&Each::picture>("picture", "a built-in picture, or a PNG (relative to the scene file's folder)").stated(),
       RowOf<Each>("resolution", "of a built-in picture; that of a PNG is its own")
           .of(SettingType::whole_tuple)
           .as("[rows, columns]")
           .within({1, 4096})
           .stored(store_resolution, resolution_of)
           .otherwise(V{std::vector<std::int64_t>{640, 640}}),
       field<&Each::seed>("seed", "which drawing of a built-in picture").within({0, 4294967295.0}).otherwise(0),
       field<&Each::colour>("colour", "by which the picture is multiplied")
           .as("[red, green, blue]")
           .within({0, 1000})
           .otherwise(V{std::vector<double>{1.0, 1.0, 1.0}}),
       choice_field<shapes, &Each::surface, &Surface::shape>(
           "shape", "a flat sheet, a ball with the picture on its front, or a sheet that stands out by heights")
           .otherwise("plane"),
       field<&Each::heights>("heights", "of a relief: a built-in picture or a PNG, black is the sheet itself"),
       field<&Each::relief_mm>("relief_mm", "how far white stands out of a relief, towards the eye where positive")
           .within(place_mm)
           .otherwise(V{0.0}),
       field<&Each::surface, &Surface::shines>("shines", "a display, to which [display] applies, and [light] does not")
           .otherwise(V{false})});
}

void add_place(std::vector<SettingOf<Each>>& all) {
  using S = Surface;
  add<Each>(
      all, "surface",
      {field<&Each::width_mm>("width_mm", "left out, as large as the object plane allows; a ball's diameter")
           .within(length_mm),
       field<&Each::height_mm>("height_mm", "left out, in proportion to the picture").within(length_mm),
       field<&Each::surface, &S::distance_mm>("distance_mm",
                                              "of its middle from the lens tip; left out, that of the object plane")
           .within(length_mm),
       field<&Each::surface, &S::pose, &Pose::centre_mm, &hal::Vec3::x>("x_mm", "of its middle, to the right")
           .within(place_mm)
           .otherwise(V{0.0}),
       field<&Each::surface, &S::pose, &Pose::centre_mm, &hal::Vec3::y>("y_mm", "of its middle, upwards")
           .within(place_mm)
           .otherwise(V{0.0}),
       degrees<&S::pose, &Pose::tilt_rad>("tilt_deg", "about the vertical: its right edge goes back").within(angle_deg),
       degrees<&S::pose, &Pose::lean_rad>("lean_deg", "about the horizontal: its upper edge goes back")
           .within(angle_deg),
       degrees<&S::pose, &Pose::roll_rad>("roll_deg", "in its own plane, counter-clockwise").within(angle_deg)});
}

void add_motion(std::vector<SettingOf<Each>>& all) {
  using S = Surface;
  add<Each>(
      all, "surface",
      {field<&Each::surface, &S::motion, &Motion::start_s>("start_s", "when it begins to move")
           .within(seconds)
           .otherwise(V{0.0}),
       field<&Each::surface, &S::motion, &Motion::velocity_mm_per_s>("velocity_mm_per_s", "z leads away from the eye")
           .as("[x, y, z]")
           .within(place_mm)
           .otherwise(V{std::vector<double>{0.0, 0.0, 0.0}}),
       degrees<&S::motion, &Motion::tilt_rad_per_s>("tilt_deg_per_s", "how fast it tilts").within(rate_deg),
       degrees<&S::motion, &Motion::lean_rad_per_s>("lean_deg_per_s", "how fast it leans").within(rate_deg),
       degrees<&S::motion, &Motion::roll_rad_per_s>("roll_deg_per_s", "how fast it rolls").within(rate_deg),
       RowOf<Each>("path",
                   "seconds after its start and mm from its place, ascending, besides its velocity; straight "
                   "from row to row, from its own place on")
           .of(SettingType::real_rows)
           .as("[t, x, y, z]")
           .within(place_mm)
           .stored(store_path, path_of)
           .otherwise(V{NumberRows()}),
       field<&Each::surface, &S::motion, &Motion::repeats>("repeats", "the path begins anew after its last row")
           .otherwise(V{false})});
}

}  // namespace

std::span<const Section> scene_sections() {
  return all_sections;
}

std::span<const SettingOf<SceneFileSettings>> scene_settings() {
  static const std::vector<SettingOf<Whole>> rows = make_scene_settings();
  return rows;
}

std::span<const SettingOf<SurfaceSettings>> surface_settings() {
  static const std::vector<SettingOf<Each>> rows = [] {
    std::vector<SettingOf<Each>> all;
    add_looks(all);
    add_place(all);
    add_motion(all);
    return all;
  }();
  return rows;
}

std::vector<SettingRule> effect_settings(std::span<const std::string_view> effects) {
  std::vector<SettingRule> rules;
  for (const std::string_view effect : effects) {
    SettingRule& rule = rules.emplace_back();
    rule.section = "effects";
    rule.key = effect;
    rule.type = SettingType::choice;
    rule.choices = {"on", "off"};
  }
  return rules;
}

}  // namespace compueye::firmware
