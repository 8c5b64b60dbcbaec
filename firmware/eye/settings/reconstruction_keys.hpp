#pragma once

#include <vector>

#include "firmware/eye/settings/board_schema.hpp"

namespace compueye::firmware {

/// The keys of [reconstruction], part of board_schema().
[[nodiscard]] std::vector<KeySpec> reconstruction_keys();

}  // namespace compueye::firmware
