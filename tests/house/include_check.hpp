#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace compueye::house {

struct Violation {
  std::string file;
  int line = 0;  ///< 0 = the file as a whole
  std::string sentence;

  /// "file:line: sentence"
  [[nodiscard]] std::string text() const;
};

/// What is wrong with the includes of one file; `file` is its path from the repository root.
[[nodiscard]] std::vector<Violation> check_includes(std::string_view file, std::string_view source);

/// One violation a line, for a test's message.
[[nodiscard]] std::string list(const std::vector<Violation>& violations);

}  // namespace compueye::house
