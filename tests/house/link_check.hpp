#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/house/include_check.hpp"

namespace compueye::house {

/// One CMake target of the project.
struct LinkLine {
  std::string target;
  std::vector<std::string> sources;  ///< from the repository root
  std::vector<std::string> links;    ///< what it links itself
};

/// Reads what write_link_lines.cmake wrote: "target|source source|library library" a line.
[[nodiscard]] std::vector<LinkLine> parse_link_lines(std::string_view text);

/// Links that the folders of a target's sources do not allow (include_rules), unknown libraries, and libraries that
/// some folder must never reach, however long the way.
[[nodiscard]] std::vector<Violation> check_links(const std::vector<LinkLine>& lines);

}  // namespace compueye::house
