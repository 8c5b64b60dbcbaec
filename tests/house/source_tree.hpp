#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace compueye::house {

/// The project's files, as paths from `root`: what git tracks or would add; without git, everything outside build/,
/// out/ and hidden folders. Sorted.
[[nodiscard]] std::vector<std::string> project_files(const std::filesystem::path& root);

/// A C++ source or header by its name.
[[nodiscard]] bool is_cpp(std::string_view file) noexcept;

/// All bytes of a file; empty when it cannot be read.
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

}  // namespace compueye::house
