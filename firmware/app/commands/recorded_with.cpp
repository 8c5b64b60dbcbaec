#include "firmware/app/commands/recorded_with.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "drivers/recording/recording_file.hpp"
#include "firmware/text/words.hpp"

namespace compueye::firmware {

std::string RecordedWith::text(const Board& board) const {
  if (!board.source.simulated()) {
    return fmt::format("board = {}\ndistance_mm = {}\n", visible_text(board.name), board.object.distance_mm);
  }
  return fmt::format("board = {}\ndistance_mm = {}\nscene = {}\nscene_seed = {}\nseed = {}\n", visible_text(board.name),
                     board.object.distance_mm, visible_text(scene), scene_seed, seed);
}

std::int64_t unix_minus(const hal::Clock& clock) {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count() - clock.now_ns();
}

hal::Result<void> check_new_recording(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (std::filesystem::is_regular_file(path, ignored)) {
    return tl::unexpected(recording::file_failure(EEXIST, path, "cannot be written"));
  }
  if (!std::filesystem::is_directory(parent.empty() ? "." : parent, ignored)) {
    return tl::unexpected(recording::file_failure(ENOENT, path, "cannot be written"));
  }
  return {};
}

}  // namespace compueye::firmware
