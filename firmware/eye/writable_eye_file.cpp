#include "firmware/eye/writable_eye_file.hpp"

#include <filesystem>
#include <system_error>

#include "firmware/eye/measured_eye.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<calib::EyeFile> writable_eye_file(const std::string& path, const Board& board) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return calib::EyeFile::create(path, {board.source.serial, board.eye, board.object});
  }
  auto file = TRY(calib::EyeFile::open(path, calib::EyeFileMode::write));
  TRY(check_is_of(file, board));
  return file;
}

}  // namespace compueye::firmware
