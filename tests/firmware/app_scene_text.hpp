#pragma once

#include <array>
#include <string>
#include <string_view>

#include "firmware/eye/scene/scene_file.hpp"

namespace compueye::firmware::test {

/// A good scene, one key a line; the line numbers are those the tests expect.
inline const std::string good_scene =
    "[scene]\n"                              // 1
    "duration_s = 5\n"                       // 2
    "[light]\n"                              // 3
    "level = 2\n"                            // 4
    "[display]\n"                            // 5
    "gamma = 2.2\n"                          // 6
    "[effects]\n"                            // 7
    "motion = \"on\"\n"                      // 8
    "[[surface]]\n"                          // 9
    "name = \"card\"\n"                      // 10
    "picture = \"star\"\n"                   // 11
    "resolution = [32, 64]\n"                // 12
    "width_mm = 6\n"                         // 13
    "distance_mm = 25\n"                     // 14
    "tilt_deg = 30\n"                        // 15
    "velocity_mm_per_s = [1, -2, 0.5]\n"     // 16
    "[[surface]]\n"                          // 17
    "picture = \"white\"\n"                  // 18
    "resolution = [8, 8]\n"                  // 19
    "colour = [1, 0.5, 0]\n"                 // 20
    "shines = true\n"                        // 21
    "path = [[1, 0, 0, 5], [2, 3, 0, 0]]\n"  // 22
    "repeats = true\n";                      // 23

inline constexpr std::array<std::string_view, 3> some_effects{"motion", "motion_blur", "read_noise"};

/// 16x20 pixels on 8.5 x 8 mm at 30 mm.
inline SceneSite some_site() {
  hal::ObjectPlane object;
  object.rows = 16;
  object.cols = 20;
  object.width_mm = 8.5;
  object.height_mm = 8.0;
  object.distance_mm = 30.0;
  return {object, std::nullopt, some_effects};
}

}  // namespace compueye::firmware::test
