#pragma once

#include <filesystem>
#include <string_view>

#include "hal/result.hpp"

namespace compueye::firmware {

/// Turns an errno into an Error whose place is `path` and whose sentence says what could not be done (`action`, for
/// example "cannot be written"), why, and what to do about it. Codes: not_found, no_space (full disk, quota, size
/// limit), otherwise io.
[[nodiscard]] hal::Error file_error(int error_number, const std::filesystem::path& path, std::string_view action);

}  // namespace compueye::firmware
