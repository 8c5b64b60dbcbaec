#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "hal/eye_geometry.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "sim/scene/surface.hpp"

namespace compueye::sim {

/// What lights the surfaces that do not shine by themselves.
struct Light {
  double level = 1.0;           ///< 0 .. 1000; a picture's 1 gives level at the middle of the object plane
  double falloff = 0.0;         ///< share of the light lost at the object plane's corner, as the square of the distance
  double drift_per_hour = 0.0;  ///< relative change of the lamp's light, linear in time
  double mains_hz = 0.0;        ///< 0, or 40 .. 500: light of the mains flickers at twice that
  double flicker_depth = 0.0;   ///< 0 .. 1: level (1 + depth sin(2 pi 2 mains t))
  std::array<double, 3> spectrum{1.0, 1.0, 1.0};  ///< red, green, blue; >= 0, not all 0
};

/// What a display does to the pictures of the surfaces that shine.
struct Display {
  double gamma = 1.0;           ///< shown = black_level + (1 - black_level) picture^gamma, 0.2 .. 5
  double black_level = 0.0;     ///< 0 .. 0.9
  double refresh_hz = 0.0;      ///< what moves on it moves in steps of 1/refresh; 0: at once
  double drift_per_hour = 0.0;  ///< relative change of its light, linear in time
  double pixel_blur = 0.0;      ///< of a pixel's width over which it runs into its neighbour, 0 .. 1
};

enum class Forced { off, on };

/// No place, size or way is larger, no scene longer.
inline constexpr double farthest_mm = 1e6;
inline constexpr double longest_scene_s = 1e6;

/// What stands before the eye, and how it changes.
struct Scene {
  std::string name;
  std::vector<Surface> surfaces;  ///< at least one
  Light light;
  Display display;
  double duration_s = 0.0;                     ///< after which it begins anew; 0: it goes on for ever
  std::map<std::string, Forced> effects = {};  ///< by an effect's name: what is not the planner's to decide

  [[nodiscard]] bool still() const noexcept;
  /// Its own time at `start_s` seconds after it was first shown, >= 0: that since it last began anew.
  [[nodiscard]] double own_time_s(double start_s) const noexcept;
  /// Its duration, or the first hour of a scene that goes on for ever.
  [[nodiscard]] double seconds_to_judge() const noexcept;
  /// The first hour, or its duration where that is longer: what lamps and sensors do slowly goes on while a scene
  /// begins anew.
  [[nodiscard]] double seconds_of_drift() const noexcept;
};

/// The picture stretched over the whole object plane.
[[nodiscard]] Scene scene_on(const hal::ObjectPlane& object, std::string name, hal::Image picture);

/// The pictures of the surfaces that do not shine times Light::level, which is 1 then.
[[nodiscard]] Scene lit(Scene scene);

/// Errors: usage (no surface), mismatch (rows, columns and number of pixels disagree; bands of several sizes; times of
/// a path that do not ascend; a motion that begins after the scene's duration; mains without flicker; heights without a
/// relief; a sphere that is none), out_of_range (empty, a size, distance or rate outside its range, a pixel that is
/// negative, NaN or infinite, named by row and column). The place is the surface's name or the scene's.
[[nodiscard]] hal::Result<void> validate(const Scene& scene);

/// What moves stays before the lens tip and within farthest_mm, within seconds_to_judge(). Of a scene that validate()
/// takes; error out_of_range with the surface's name.
[[nodiscard]] hal::Result<void> validate_travel(const Scene& scene, double object_distance_mm);

}  // namespace compueye::sim
