#pragma once

#include <string>

#include "firmware/eye/settings/board_schema.hpp"
#include "firmware/eye/settings/toml_document.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Every key of the document is known, is of the right type and in range, and no required key is missing. One
/// fault is reported: the first unknown section, else the first bad line, else the first missing key (last, so that a
/// misspelt key is told as that).
[[nodiscard]] hal::Result<void> check_against_schema(const TomlDocument& document, const std::string& file);

/// One value against its key. Errors have an empty place: bad_format (type), out_of_range, not_found (choice).
[[nodiscard]] hal::Result<void> check_value(const KeySpec& spec, const TomlValue& value);

}  // namespace compueye::firmware
