#pragma once

#include <span>
#include <string_view>

namespace compueye::house {

/// What one folder may include and link. Lists are words separated by spaces.
struct FolderRule {
  std::string_view folder;        ///< from the repository root; the longest one that holds a file counts
  std::string_view project;       ///< folders (without those that have a row of their own) or headers; "*" = any
  std::string_view libraries;     ///< names of Library; "*" = any
  bool os_headers = false;        ///< <unistd.h>, <sys/...>, <linux/...> and their kind
  std::string_view banned_std;    ///< standard headers that are refused here
  bool one_library_each = false;  ///< a file may use one third-party library at most
  std::string_view rule;          ///< the sentence behind the row
};

/// A third-party library: the only ones there are. One more needs a line here and one in docs/dependencies.md.
struct Library {
  std::string_view name;
  std::string_view headers;  ///< names, or prefixes ending in "/"
  std::string_view targets;  ///< what CMake calls it
};

[[nodiscard]] std::span<const FolderRule> folder_rules() noexcept;
[[nodiscard]] std::span<const Library> libraries() noexcept;

/// The row for a file ("recon/core/bases/dct.hpp"); nullptr when no row holds it.
[[nodiscard]] const FolderRule* rule_for(std::string_view file) noexcept;
/// nullptr when the header, or the CMake target, belongs to no known library.
[[nodiscard]] const Library* library_of_header(std::string_view header) noexcept;
[[nodiscard]] const Library* library_of_target(std::string_view target) noexcept;

[[nodiscard]] bool is_standard_header(std::string_view header) noexcept;
[[nodiscard]] bool is_os_header(std::string_view header) noexcept;

/// Whether `words`, separated by spaces, contain `word`.
[[nodiscard]] bool has_word(std::string_view words, std::string_view word) noexcept;

/// Whether `rule` lets a file include the project's header `path`.
[[nodiscard]] bool opens(const FolderRule& rule, std::string_view path) noexcept;
/// Whether `rule` lets a target link a target made of files in the folder of `other`.
[[nodiscard]] bool opens_folder(const FolderRule& rule, const FolderRule& other) noexcept;

}  // namespace compueye::house
