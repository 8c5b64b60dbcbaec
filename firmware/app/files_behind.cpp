#include "firmware/app/files_behind.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <variant>

#include "firmware/eye/scene/scene_pictures.hpp"
#include "firmware/eye/settings/toml_document.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/shared_folders.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) noexcept {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

void add(const fs::path& named, std::vector<std::string>& files) {
  std::error_code error;
  const std::string file = fs::canonical(named, error).string();
  // Two files may name each other.
  if (error || std::find(files.begin(), files.end(), file) != files.end()) return;
  files.push_back(file);
  constexpr std::uint64_t largest_file = 1U << 20U;
  if (extension_of(file) != ".toml") return;
  const auto text = read_whole_file(file, largest_file);
  const auto document = text ? parse_toml(*text, file) : hal::Result<TomlDocument>();
  if (!document) return;  // whoever reads it says why
  for (const TomlEntry& entry : document->entries) {
    const auto* name = std::get_if<std::string>(&entry.value);
    if (name == nullptr || name->empty()) continue;
    if (const fs::path other = fs::path(file).parent_path() / *name; is_file(other)) add(other, files);
  }
}

}  // namespace

std::vector<std::string> files_behind(const std::string& given) {
  std::vector<std::string> files;
  for (const fs::path& meant :
       {fs::path(given), fs::path(given_or_shared(given, "boards")), fs::path(given_or_shared(given, "scenes")),
        fs::path(given_or_shared(given + ".toml", "scenes"))}) {
    for (const fs::path& file : {meant, meant / "board.toml"}) {
      if (is_file(file)) add(file, files);
    }
  }
  return files;
}

}  // namespace compueye::firmware
