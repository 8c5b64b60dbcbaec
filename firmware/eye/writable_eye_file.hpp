#pragma once

#include <string>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/eye/board.hpp"

namespace compueye::firmware {

/// The eye file of a board's eye, at whatever distance, made where there is none. Errors: those of calib::EyeFile and
/// of check_is_of().
[[nodiscard]] hal::Result<calib::EyeFile> writable_eye_file(const std::string& path, const Board& board);

}  // namespace compueye::firmware
