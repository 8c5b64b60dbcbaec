#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/settings/setting.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

struct TomlSection {
  std::string name;
  int line = 0;
  int number = 0;       ///< which [[name]], from 0
  bool listed = false;  ///< [[name]], not [name]
};

/// `section` is empty for a key above the first [section].
struct TomlEntry {
  std::string section;
  std::string key;
  SettingValue value;
  int line = 0;
  std::string written;  ///< a number as the file spells it, "8.0"; empty: anything else
  int number = 0;       ///< of its section
};

/// A TOML file of one level of sections, flat and in the order of its lines.
struct TomlDocument {
  std::vector<TomlSection> sections;
  std::vector<TomlEntry> entries;
};

/// Errors: bad_format with "file:line" as place; the sentence names the column and what the parser met.
[[nodiscard]] hal::Result<TomlDocument> parse_toml(std::string_view text, const std::string& file);

}  // namespace compueye::firmware
