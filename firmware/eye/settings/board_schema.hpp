#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/settings/toml_value.hpp"

namespace compueye::firmware {

enum class ValueType {
  identifier,  ///< text of letters, digits, '.', '_', '-', 1 to 64 characters
  text,        ///< one line of at most 1000 characters
  choice,      ///< one of KeySpec::choices
  whole,       ///< a whole number in KeySpec::range
  real,        ///< a finite number in KeySpec::range; a whole number will do
  whole_list,  ///< distinct whole numbers in KeySpec::range
  real_pair,   ///< two numbers in KeySpec::range, the first below the second
};

/// Allowed numbers; an open end is not itself allowed.
struct Range {
  double least = 0.0;
  double most = 0.0;
  bool open_least = false;
  bool open_most = false;

  /// False for NaN.
  [[nodiscard]] bool holds(double value) const noexcept;
  /// "from 1 to 4096", "more than 0 and at most 120".
  [[nodiscard]] std::string words() const;
};

struct SectionSpec {
  std::string_view name;
  std::string_view meaning;
};

/// One key of board.toml: the single source for loading, checking, suggesting and documenting it.
struct KeySpec {
  std::string_view section;
  std::string_view name;
  ValueType type = ValueType::text;
  Range range = {};
  std::vector<std::string_view> choices = {};
  bool required = false;
  std::optional<TomlValue> fallback = {};  ///< absent and not required: the meaning says what happens
  std::string_view meaning;
  void (*store)(Board&, const TomlValue&) = nullptr;  ///< only ever given a value that passed check_value()

  /// What a good value is, to end "expected ...": "a whole number from 1 to 4096".
  [[nodiscard]] std::string expectation() const;
};

[[nodiscard]] std::span<const SectionSpec> board_sections();
/// In the order of the sections.
[[nodiscard]] std::span<const KeySpec> board_schema();
/// nullptr when there is no such key.
[[nodiscard]] const KeySpec* find_key(std::string_view section, std::string_view key) noexcept;

/// The rows of the section's table in docs/board-file.md.
[[nodiscard]] std::string reference_table(std::string_view section);

}  // namespace compueye::firmware
