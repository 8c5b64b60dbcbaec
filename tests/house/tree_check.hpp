#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/house/include_check.hpp"

namespace compueye::house {

/// A source file as far as its includes go.
struct SourceFile {
  std::string path;                   ///< from the repository root
  std::vector<std::string> includes;  ///< headers as they are written
};

[[nodiscard]] SourceFile read_source(std::string_view path, std::string_view text);

/// From one folder to another.
struct Way {
  std::string_view from;
  std::string_view to;
};

/// Folders that include each other, however long the way round; a way of `known` does not count. Each violation names
/// one include of the cycle.
[[nodiscard]] std::vector<Violation> check_cycles(std::span<const SourceFile> files, std::span<const Way> known);

/// Files that include a header of `library`, itself or through a header of the project.
[[nodiscard]] std::vector<std::string> files_with(std::span<const SourceFile> files, std::string_view library);

}  // namespace compueye::house
