#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace compueye::house {

struct Include {
  int line = 0;        ///< from 1
  std::string header;  ///< without quotes or brackets; for `#include MACRO` the macro
  enum class Form { quoted, angled, macro } form = Form::quoted;
};

/// Every #include of a C++ source, also those that the preprocessor would skip; none in comments or string literals.
[[nodiscard]] std::vector<Include> scan_includes(std::string_view source);

}  // namespace compueye::house
