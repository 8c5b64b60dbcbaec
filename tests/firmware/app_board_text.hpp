#pragma once

#include <string>
#include <string_view>

namespace compueye::firmware::test {

/// A good board, one key a line; the line numbers are those the tests expect.
inline const std::string good_board =
    "[board]\n"                          // 1
    "name = \"test-eye\"\n"              // 2
    "[eye]\n"                            // 3
    "rows = 8\n"                         // 4
    "columns = 10\n"                     // 5
    "interommatidial_angle_deg = 1.5\n"  // 6
    "acceptance_angle_deg = 8\n"         // 7
    "[object]\n"                         // 8
    "rows = 16\n"                        // 9
    "columns = 20\n"                     // 10
    "width_mm = 8.5\n"                   // 11
    "height_mm = 8\n"                    // 12
    "distance_mm = 30\n"                 // 13
    "[sensor]\n"                         // 14
    "bits = 16\n"                        // 15
    "full_scale = 128\n"                 // 16
    "read_noise_lsb = 1\n"               // 17
    "dead = [7, 3]\n"                    // 18
    "[source]\n"                         // 19
    "kind = \"sim\"\n"                   // 20
    "frame_rate_hz = 200\n"              // 21
    "[reconstruction]\n"                 // 22
    "constraint = \"box\"\n"             // 23
    "box = [0, 1.5]\n"                   // 24
    "[scene]\n"                          // 25
    "default = \"fig2\"\n";              // 26

/// `text` with its only `old` replaced; empty when there is not exactly one.
inline std::string replaced(std::string text, std::string_view old, std::string_view with) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos || text.find(old, at + 1) != std::string::npos) return {};
  return text.replace(at, old.size(), with);
}

}  // namespace compueye::firmware::test
