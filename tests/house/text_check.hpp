#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/house/include_check.hpp"

namespace compueye::house {

/// Lines that name a folder of one person's machine or the host of a package mirror: neither exists elsewhere.
[[nodiscard]] std::vector<Violation> check_places(std::string_view file, std::string_view text);

/// A source or script of more than 400 lines does more than one thing.
[[nodiscard]] std::vector<Violation> check_length(std::string_view file, std::string_view text);

/// Folders whose name says nothing about what is inside.
[[nodiscard]] std::vector<Violation> check_folder_names(std::string_view file);

}  // namespace compueye::house
