#include "tests/house/link_check.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "tests/house/include_rules.hpp"

namespace compueye::house {
namespace {

struct NeverReaches {
  std::string_view folder;
  std::string_view libraries;
};

// Checked through every target in between, so that no library sneaks in behind another.
constexpr std::array<NeverReaches, 5> never{{
    {"hal", "Eigen Spectra xxhash libpng toml++ CLI11 fmt nlohmann-json sqlite libusb hidapi libgpiod"},
    {"recon/core", "Eigen Spectra xxhash libpng toml++ CLI11 fmt nlohmann-json sqlite libusb hidapi libgpiod"},
    {"sim", "libusb hidapi libgpiod sqlite Eigen"},
    {"firmware/pipeline", "sqlite libusb hidapi libgpiod libpng toml++"},
    {"calib", "libusb hidapi libgpiod sqlite"},
}};

constexpr std::string_view of_the_system = "Threads::Threads compueye_flags m dl rt";

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, by);) {
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

const LinkLine* find(const std::vector<LinkLine>& lines, std::string_view target) {
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const LinkLine& l) { return l.target == target; });
  return found == lines.end() ? nullptr : &*found;
}

std::set<const FolderRule*> rules_of(const LinkLine& line) {
  std::set<const FolderRule*> rules;
  for (const std::string& source : line.sources) {
    if (const FolderRule* rule = rule_for(source)) rules.insert(rule);
  }
  return rules;
}

/// Why no folder among `rules` may link `link`; empty when one may.
std::string objection(const std::set<const FolderRule*>& rules, const std::string& link,
                      const std::vector<LinkLine>& lines) {
  if (has_word(of_the_system, link)) return "";
  const LinkLine* ours = find(lines, link);
  const Library* library = library_of_target(link);
  if (ours == nullptr && library == nullptr) return "which tests/house/include_rules.cpp does not know";
  const auto may = [&](const FolderRule* rule) {
    if (library != nullptr) return rule->libraries == "*" || has_word(rule->libraries, library->name);
    const auto others = rules_of(*ours);
    return std::all_of(others.begin(), others.end(),
                       [&](const FolderRule* other) { return other == rule || opens_folder(*rule, *other); });
  };
  if (rules.empty() || std::any_of(rules.begin(), rules.end(), may)) return "";
  std::string why = "rule";
  for (const FolderRule* rule : rules) why += ": " + std::string(rule->rule);
  return why;
}

void collect(const LinkLine& line, const std::vector<LinkLine>& lines, std::set<std::string>& reached) {
  for (const std::string& link : line.links) {
    if (!reached.insert(link).second) continue;
    if (const LinkLine* next = find(lines, link)) collect(*next, lines, reached);
  }
}

}  // namespace

std::vector<LinkLine> parse_link_lines(std::string_view text) {
  std::vector<LinkLine> lines;
  for (const std::string& row : split(std::string(text), '\n')) {
    const auto first = row.find('|');
    const auto second = row.find('|', first == std::string::npos ? first : first + 1);
    if (second == std::string::npos) continue;
    lines.push_back({row.substr(0, first), split(row.substr(first + 1, second - first - 1), ' '),
                     split(row.substr(second + 1), ' ')});
  }
  return lines;
}

std::vector<Violation> check_links(const std::vector<LinkLine>& lines) {
  std::vector<Violation> violations;
  for (const LinkLine& line : lines) {
    const auto rules = rules_of(line);
    for (const std::string& link : line.links) {
      if (std::string why = objection(rules, link, lines); !why.empty()) {
        violations.push_back({"target " + line.target, 0, "links " + link + "; " + why});
      }
    }
    std::set<std::string> reached;
    collect(line, lines, reached);
    for (const auto& [folder, libraries] : never) {
      const FolderRule* forbidding = rule_for(folder);
      if (!rules.contains(forbidding)) continue;
      for (const std::string& link : reached) {
        const Library* library = library_of_target(link);
        if (library != nullptr && has_word(libraries, library->name)) {
          violations.push_back(
              {"target " + line.target, 0, "reaches " + link + "; rule: " + std::string(forbidding->rule)});
        }
      }
    }
  }
  return violations;
}

}  // namespace compueye::house
