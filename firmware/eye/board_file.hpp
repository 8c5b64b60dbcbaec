#pragma once

#include <filesystem>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// The board.toml meant by `given`: a folder that holds one, or the file itself. not_found lists the boards that lie
/// where `given` was looked for, the nearest name first of all.
[[nodiscard]] hal::Result<std::filesystem::path> find_board_file(const std::filesystem::path& given);

/// The text of a regular file of at most 1 MiB. Errors: io, bad_format (something else, or larger).
[[nodiscard]] hal::Result<std::string> read_board_file(const std::filesystem::path& file);

}  // namespace compueye::firmware
