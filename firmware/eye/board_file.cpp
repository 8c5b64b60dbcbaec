#include "firmware/eye/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "firmware/files/shared_folders.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;

constexpr std::string_view file_name = "board.toml";
constexpr std::uintmax_t largest_file = 1U << 20U;

std::vector<std::string> boards_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (fs::is_regular_file(at->path() / file_name, ignored)) names.push_back(at->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Where a person most likely keeps boards: beside the one asked for, in ./boards, else with the machine's.
std::string boards_nearby(const fs::path& given) {
  const fs::path whole = given.filename() == file_name ? given.parent_path() : given;
  const fs::path named = whole.has_filename() ? whole : whole.parent_path();
  const fs::path beside = named.has_parent_path() ? named.parent_path() : fs::path(".");
  std::vector<fs::path> folders{beside, "boards"};
  if (shared_name(given.string(), "boards")) {
    for (const std::string& folder : shared_folders("boards")) folders.emplace_back(folder);
  }
  std::string listed;
  for (const fs::path& folder : folders) {
    const std::vector<std::string> names = boards_in(folder);
    if (names.empty()) continue;
    const std::vector<std::string_view> views(names.begin(), names.end());
    if (const auto near = nearest_name(named.filename().string(), views)) {
      const fs::path meant = folder == "." ? fs::path(*near) : folder / *near;
      return fmt::format("; did you mean '{}'?", meant.string());
    }
    if (listed.empty()) listed = fmt::format("; the boards in '{}' are {}", folder.string(), fmt::join(names, ", "));
  }
  return !listed.empty() ? listed : fmt::format("; there is no board in '{}' either", beside.string());
}

/// The board.toml meant by `given`: a folder that holds one, or the file itself. not_found lists the boards that lie
/// where `given` was looked for, or says which has the nearest name.
hal::Result<fs::path> find_board_file(const fs::path& given) {
  if (given.empty()) {
    return hal::fail(ErrorCode::usage, "--board", "is empty, expected the folder of a board, such as boards/sim-8x8");
  }
  std::error_code error;
  const fs::file_status status = fs::status(given, error);
  if (status.type() == fs::file_type::not_found) {
    return hal::fail(ErrorCode::not_found, given.string(),
                     "no such board" + boards_nearby(given) + shared_folders_searched(given.string(), "boards"));
  }
  if (status.type() == fs::file_type::none) {
    return hal::fail(ErrorCode::io, given.string(), "cannot look at the board: " + error.message());
  }
  if (fs::is_regular_file(status)) return given;
  if (!fs::is_directory(status)) {
    return hal::fail(ErrorCode::bad_format, given.string(),
                     "is neither a folder nor a file, expected the folder of a board");
  }
  const fs::path file = given / file_name;
  if (fs::exists(file, error)) return file;
  if (error) return hal::fail(ErrorCode::io, file.string(), "cannot look at the file: " + error.message());
  const std::vector<std::string> inside = boards_in(given);
  const std::string hint = inside.empty()
                               ? boards_nearby(given)
                               : fmt::format("; it holds the boards {}, name one of them", fmt::join(inside, ", "));
  return hal::fail(ErrorCode::not_found, given.string(), "the folder has no board.toml" + hint);
}

/// The text of a regular file. Errors: io, bad_format (something else, or too large).
hal::Result<std::string> read_board_file(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    return hal::fail(ErrorCode::bad_format, file.string(), "is not a regular file, expected a TOML text");
  }
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return hal::fail(ErrorCode::io, file.string(), "cannot read the file: " + error.message());
  if (size > largest_file) {
    return hal::fail(ErrorCode::bad_format, file.string(),
                     fmt::format("is {} bytes long, a board file has at most {}", size, largest_file));
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  // Inserting the buffer of an empty file would set failbit.
  if (stream && size > 0) text << stream.rdbuf();
  if (!stream || !text) {
    return hal::fail(ErrorCode::io, file.string(),
                     "cannot read the file: " + std::generic_category().message(errno == 0 ? EIO : errno));
  }
  return text.str();
}

}  // namespace

hal::Result<Board> load_board(const std::string& folder) {
  const fs::path file = TRY(find_board_file(given_or_shared(folder, "boards")));
  Board board = TRY(parse_board(TRY(read_board_file(file)), file.string()));
  board.folder = file.has_parent_path() ? file.parent_path().string() : ".";
  return board;
}

}  // namespace compueye::firmware
