#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "hal/try.hpp"
#include "sim/scene/scene.hpp"
#include "sim/scene/travel.hpp"

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// What a value of a surface or of the whole scene has to be.
struct Check {
  const std::string& name;  ///< whose value it is

  [[nodiscard]] Result<void> within(std::string_view what, double value, double least, double most) const {
    if (value >= least && value <= most) return {};
    return fail(ErrorCode::out_of_range, name,
                std::string(what) + " is " + std::to_string(value) + ", expected " + std::to_string(least) + " to " +
                    std::to_string(most));
  }
  [[nodiscard]] Result<void> length(std::string_view what, double value) const {
    if (value > 0.0 && value <= farthest_mm) return {};
    return fail(ErrorCode::out_of_range, name,
                std::string(what) + " is " + std::to_string(value) + ", expected more than 0 mm and at most " +
                    std::to_string(farthest_mm));
  }
  [[nodiscard]] Result<void> place(std::string_view what, const hal::Vec3& v, double most) const {
    TRY(within(what, v.x, -most, most));
    TRY(within(what, v.y, -most, most));
    return within(what, v.z, -most, most);
  }
  [[nodiscard]] Result<void> needs(bool is, std::string_view what, std::string_view other) const {
    if (is) return {};
    return fail(ErrorCode::mismatch, name, std::string(what) + " goes with " + std::string(other));
  }
};

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
  // All at once, a NaN being in no range; where one is out of it is asked only then.
  const auto bad = std::count_if(picture.pixels.begin(), picture.pixels.end(), [least](float value) {
    return !(value >= least && value <= std::numeric_limits<float>::max());
  });
  for (int row = 0; bad > 0 && row < picture.rows; ++row) {
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

Result<void> check_motion(const Surface& surface) {
  constexpr double turns_per_s = 1e3;
  const Check check{surface.name};
  const Motion& motion = surface.motion;
  TRY(check.within("start_s", motion.start_s, 0.0, longest_scene_s));
  TRY(check.place("velocity_mm_per_s", motion.velocity_mm_per_s, farthest_mm));
  TRY(check.within("tilt_rad_per_s", motion.tilt_rad_per_s, -turns_per_s, turns_per_s));
  TRY(check.within("lean_rad_per_s", motion.lean_rad_per_s, -turns_per_s, turns_per_s));
  TRY(check.within("roll_rad_per_s", motion.roll_rad_per_s, -turns_per_s, turns_per_s));
  TRY(check.within("steps_hz", motion.steps_hz, 0.0, 1e6));
  double before = -1.0;
  for (const Waypoint& waypoint : motion.path) {
    TRY(check.within("a time of path", waypoint.t_s, 0.0, longest_scene_s));
    TRY(check.place("an offset of path", waypoint.offset_mm, farthest_mm));
    if (!(waypoint.t_s > before)) {
      return fail(ErrorCode::mismatch, surface.name,
                  "path is at t = " + std::to_string(waypoint.t_s) + " s after t = " + std::to_string(before) +
                      " s, expected ascending times");
    }
    before = waypoint.t_s;
  }
  return check.needs(!motion.repeats || before > 0.0, "repeats", "a path of more than 0 s");
}

Result<void> check_shape(const Surface& surface) {
  const Check check{surface.name};
  TRY(check.length("width_mm", surface.width_mm));
  TRY(check.length("height_mm", surface.height_mm));
  TRY(check.length("distance_mm", surface.distance_mm.value_or(1.0)));
  TRY(check.place("its place in mm", surface.pose.centre_mm, farthest_mm));
  constexpr double most_rad = 10.0;
  TRY(check.within("tilt_rad", surface.pose.tilt_rad, -most_rad, most_rad));
  TRY(check.within("lean_rad", surface.pose.lean_rad, -most_rad, most_rad));
  TRY(check.within("roll_rad", surface.pose.roll_rad, -most_rad, most_rad));
  const bool relief = surface.shape == Shape::relief;
  TRY(check.needs(relief == !surface.heights.pixels.empty(), "a relief", "heights, and no other shape does"));
  if (relief) TRY(check_picture(surface.name, surface.heights, static_cast<float>(-farthest_mm)));
  return check.needs(surface.shape != Shape::sphere || surface.width_mm == surface.height_mm, "a sphere",
                     "a height_mm that is its width_mm");
}

Result<void> check_surface(const Surface& surface) {
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
  TRY(check_shape(surface));
  return check_motion(surface);
}

/// A scene that begins anew before a motion begins never moves.
Result<void> check_begins(const Surface& surface, double duration_s) {
  if (duration_s == 0.0 || surface.motion.start_s < duration_s) return {};
  return fail(ErrorCode::mismatch, surface.name,
              "start_s is " + std::to_string(surface.motion.start_s) + " s, which a scene of " +
                  std::to_string(duration_s) + " s never comes to");
}

Result<void> check_light(const std::string& name, const Light& light) {
  const Check check{name};
  TRY(check.within("[light] level", light.level, 0.0, 1000.0));
  TRY(check.within("[light] falloff", light.falloff, 0.0, 1.0));
  TRY(check.within("[light] drift_per_hour", light.drift_per_hour, -1.0, 10.0));
  if (light.mains_hz != 0.0) TRY(check.within("[light] mains_hz", light.mains_hz, 40.0, 500.0));
  TRY(check.within("[light] flicker_depth", light.flicker_depth, 0.0, 1.0));
  TRY(check.needs(light.flicker_depth == 0.0 || light.mains_hz > 0.0, "[light] flicker_depth", "[light] mains_hz"));
  TRY(check.needs(light.mains_hz == 0.0 || light.flicker_depth > 0.0, "[light] mains_hz", "[light] flicker_depth"));
  for (const double band : light.spectrum) TRY(check.within("[light] spectrum", band, 0.0, 1e6));
  if (std::any_of(light.spectrum.begin(), light.spectrum.end(), [](double band) { return band > 0.0; })) return {};
  return fail(ErrorCode::out_of_range, name, "[light] spectrum is 0 everywhere, expected one value above 0");
}

Result<void> check_display(const std::string& name, const Display& display) {
  const Check check{name};
  TRY(check.within("[display] gamma", display.gamma, 0.2, 5.0));
  TRY(check.within("[display] black_level", display.black_level, 0.0, 0.9));
  TRY(check.within("[display] drift_per_hour", display.drift_per_hour, -1.0, 10.0));
  TRY(check.within("[display] refresh_hz", display.refresh_hz, 0.0, 1e6));
  return check.within("[display] pixel_blur", display.pixel_blur, 0.0, 1.0);
}

}  // namespace

constexpr double hour_s = 3600.0;

double Scene::seconds_to_judge() const noexcept {
  return duration_s > 0.0 ? std::min(duration_s, longest_scene_s) : hour_s;
}

double Scene::seconds_of_drift() const noexcept {
  return std::max(seconds_to_judge(), hour_s);
}

Result<void> validate(const Scene& scene) {
  if (scene.surfaces.empty()) {
    return fail(ErrorCode::usage, scene.name, "there is nothing to see in it, expected at least one surface");
  }
  for (const Surface& surface : scene.surfaces) TRY(check_surface(surface));
  TRY(Check{scene.name}.within("duration_s", scene.duration_s, 0.0, longest_scene_s));
  for (const Surface& surface : scene.surfaces) TRY(check_begins(surface, scene.duration_s));
  TRY(check_light(scene.name, scene.light));
  return check_display(scene.name, scene.display);
}

Result<void> validate_travel(const Scene& scene, double object_distance_mm) {
  for (const Surface& surface : scene.surfaces) {
    const Travel travel = travel_of(surface, object_distance_mm, scene.seconds_to_judge(), farthest_mm);
    const auto at = [](double t_s) { return " at t = " + std::to_string(t_s) + " s"; };
    if (travel.too_far_at_s) {
      return fail(ErrorCode::out_of_range, surface.name,
                  "moves beyond " + std::to_string(farthest_mm) + " mm" + at(*travel.too_far_at_s) +
                      "; slow it down, or give the scene a duration_s after which it begins anew");
    }
    if (!travel.inside_at_s) continue;
    return fail(ErrorCode::out_of_range, surface.name,
                "reaches into the eye" + at(*travel.inside_at_s) + ", and to z = " + std::to_string(travel.nearest_mm) +
                    " mm from the lens tip on its way, expected more than 0 mm all along");
  }
  return {};
}

}  // namespace compueye::sim
