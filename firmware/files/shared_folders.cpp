#include "firmware/files/shared_folders.hpp"

#include <cstdlib>
#include <filesystem>
#include <set>
#include <system_error>

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

/// "COMPUEYE_BOARDS" of "boards".
std::string variable_of(std::string_view kind) {
  std::string name = "COMPUEYE_";
  for (const char c : kind) name += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return name;
}

}  // namespace

std::vector<std::string> shared_folders(std::string_view kind) {
  std::vector<std::string> folders;
  if (const char* told = std::getenv(variable_of(kind).c_str()); told != nullptr && *told != '\0') {
    folders.emplace_back(told);
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back((program.parent_path().parent_path() / "share" / "compueye" / kind).string());
  return folders;
}

std::vector<std::string> shared_names(std::string_view kind) {
  std::set<std::string> names;
  for (const std::string& folder : shared_folders(kind)) {
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      std::error_code ignored;
      const bool is_board = fs::is_regular_file(at->path() / "board.toml", ignored);
      const bool is_file = at->path().extension() == ".toml" && fs::is_regular_file(at->path(), ignored);
      if (kind == "boards" ? is_board : is_file) names.insert(at->path().filename().string());
    }
  }
  return {names.begin(), names.end()};
}

std::optional<std::string> shared_name(const std::string& given, std::string_view kind) {
  const fs::path path = fs::path(given).lexically_normal();
  const fs::path whole = path.has_filename() ? path : path.parent_path();  // "sim-8x8/"
  if (whole.empty() || whole == "." || whole == ".." || whole.is_absolute()) return std::nullopt;
  if (whole.has_parent_path() && whole.parent_path() != fs::path(kind)) return std::nullopt;
  return whole.filename().string();
}

std::string given_or_shared(const std::string& given, std::string_view kind) {
  std::error_code error;
  const auto name = shared_name(given, kind);
  if (!name || fs::status(given, error).type() != fs::file_type::not_found) return given;
  for (const std::string& folder : shared_folders(kind)) {
    const fs::path found = fs::path(folder) / *name;
    if (fs::exists(found, error)) return found.string();
  }
  return given;
}

std::string shared_folders_searched(const std::string& given, std::string_view kind) {
  if (!shared_name(given, kind)) return {};
  std::string text;
  for (const std::string& folder : shared_folders(kind)) {
    text += (text.empty() ? "; looked in '" : " and '") + folder + "'";
  }
  return text.empty() ? text : text + " too";
}

}  // namespace compueye::firmware
