#include "tests/house/source_tree.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

namespace compueye::house {
namespace {

namespace fs = std::filesystem;

/// Empty when git is absent or `root` is no work tree.
std::vector<std::string> files_by_git(const fs::path& root) {
  // A clone that belongs to somebody else (a container's root) is still ours to read.
  const std::string command = "git -c safe.directory='*' -C '" + root.string() +
                              "' ls-files -z --cached --others --exclude-standard 2>/dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::string names;
  std::array<char, 4096> buffer{};
  for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    names.append(buffer.data(), got);
  }
  if (::pclose(pipe) != 0) return {};
  std::vector<std::string> files;
  std::istringstream stream(names);
  for (std::string name; std::getline(stream, name, '\0');) files.push_back(name);
  return files;
}

std::vector<std::string> files_by_walking(const fs::path& root) {
  std::vector<std::string> files;
  for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator(); ++it) {
    const std::string name = it->path().filename().string();
    const bool top = it.depth() == 0;
    if (it->is_directory() &&
        ((name.starts_with('.') && name != ".ci") || (top && (name == "build" || name == "out")))) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      files.push_back(fs::relative(it->path(), root).generic_string());
    }
  }
  return files;
}

}  // namespace

std::vector<std::string> project_files(const fs::path& root) {
  std::vector<std::string> files = files_by_git(root);
  if (files.empty()) files = files_by_walking(root);
  // git still lists what was deleted and not yet committed, and a file in conflict more than once.
  std::erase_if(files, [&](const std::string& file) { return !fs::is_regular_file(root / file); });
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

bool is_cpp(std::string_view file) noexcept {
  constexpr std::array<std::string_view, 10> endings{".cpp", ".hpp", ".h",   ".c",   ".cc",
                                                     ".cxx", ".hh",  ".hxx", ".inc", ".ipp"};
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) { return file.ends_with(ending); });
}

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace compueye::house
