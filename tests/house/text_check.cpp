#include "tests/house/text_check.hpp"

#include <algorithm>
#include <array>

#include "tests/house/include_rules.hpp"
#include "tests/house/source_tree.hpp"

namespace compueye::house {
namespace {

constexpr std::ptrdiff_t most_lines = 400;

struct LongFile {
  std::string_view file;
  std::string_view reason;
};
constexpr std::array<LongFile, 0> long_files{};

constexpr std::string_view nameless_folders = "util utils common helper helpers misc stuff";

// Written without their leading slash, so that this file passes its own check.
constexpr std::array<std::string_view, 4> machine_folders{"work", "home", "root", "Users"};

// A host is a mirror's when one of these is its first label.
constexpr std::string_view mirror_labels = "deb ftp mirror mirrors archive security snapshot registry proxy cdn";

bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

/// Where "/folder" starts as an absolute path: not inside a longer path, a variable's path or an address.
bool names_machine_folder(std::string_view line, std::string_view folder) {
  for (auto at = line.find('/'); at != std::string_view::npos; at = line.find('/', at + 1)) {
    const std::string_view rest = line.substr(at + 1);
    if (!rest.starts_with(folder)) continue;
    const bool starts =
        at == 0 || (!is_name(line[at - 1]) && std::string_view("/}>)*~").find(line[at - 1]) == std::string_view::npos);
    const bool ends = rest.size() == folder.size() || !is_name(rest[folder.size()]);
    if (starts && ends) return true;
  }
  return false;
}

/// The first host of a mirror in `line`, empty when there is none. Hosts: what follows "://", and Debian's own.
std::string_view mirror_host(std::string_view line) {
  for (std::size_t at = 0; at < line.size();) {
    if (!is_name(line[at])) {
      ++at;
      continue;
    }
    auto end = at;
    while (end < line.size() && is_name(line[end])) ++end;
    const std::string_view host = line.substr(at, end - at);
    const bool addressed = at >= 3 && line.substr(at - 3, 3) == "://";
    const bool debian = host.ends_with(".debian.org") || host.ends_with(".debian.net");
    if ((addressed || debian) && has_word(mirror_labels, host.substr(0, host.find('.'))) &&
        host.find('.') != std::string_view::npos)
      return host;
    at = end;
  }
  return {};
}

template <typename Check>
void for_each_line(std::string_view text, Check check) {
  for (int line = 1; !text.empty(); ++line) {
    const auto end = text.find('\n');
    check(line, text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

bool is_code(std::string_view file) {
  return is_cpp(file) || file.ends_with(".cmake") || file.ends_with("CMakeLists.txt") || file.ends_with(".sh") ||
         file.ends_with(".sql") || file.ends_with(".py") || (file.starts_with("tools/") && !file.ends_with(".list"));
}

}  // namespace

std::vector<Violation> check_places(std::string_view file, std::string_view text) {
  std::vector<Violation> violations;
  if (text.find('\0') != std::string_view::npos) return violations;  // a picture or an array
  for_each_line(text, [&](int number, std::string_view line) {
    for (const std::string_view folder : machine_folders) {
      if (!names_machine_folder(line, folder)) continue;
      violations.push_back({std::string(file), number,
                            "names a path below /" + std::string(folder) +
                                ", which exists on one machine only; write "
                                "it relative to the project"});
    }
    if (const auto host = mirror_host(line); !host.empty()) {
      violations.push_back({std::string(file), number,
                            "names the mirror " + std::string(host) + "; the machine's own package set-up decides"});
    }
  });
  return violations;
}

std::vector<Violation> check_length(std::string_view file, std::string_view text) {
  const bool excused =
      std::any_of(long_files.begin(), long_files.end(), [&](const LongFile& each) { return each.file == file; });
  const auto lines = std::count(text.begin(), text.end(), '\n');
  if (excused || !is_code(file) || lines <= most_lines) return {};
  return {{std::string(file), 0,
           "has " + std::to_string(lines) + " lines, expected at most " + std::to_string(most_lines) +
               "; split it by idea"}};
}

std::vector<Violation> check_folder_names(std::string_view file) {
  for (auto rest = file; rest.find('/') != std::string_view::npos; rest.remove_prefix(rest.find('/') + 1)) {
    const std::string_view folder = rest.substr(0, rest.find('/'));
    if (!has_word(nameless_folders, folder)) continue;
    return {{std::string(file), 0,
             "lies in a folder named '" + std::string(folder) + "'; name the folder after what is inside"}};
  }
  return {};
}

}  // namespace compueye::house
