#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/settings/toml_document.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Which sections and keys a kind of file may have.
struct DocumentRules {
  std::span<const Section> sections;
  std::vector<const SettingRule*> keys;

  [[nodiscard]] const SettingRule* find(std::string_view section, std::string_view key) const noexcept;
};

/// Every key of the document is known, is of the right type and in range, and no required key is missing. One fault is
/// reported: the first unknown section, else the first bad line, else the first missing key (last, so that a misspelt
/// key is told as that). Errors not_found, bad_format, out_of_range at "file:line".
[[nodiscard]] hal::Result<void> check_document(const TomlDocument& document, const DocumentRules& rules,
                                               const std::string& file);

}  // namespace compueye::firmware
