#include "tests/house/include_check.hpp"

#include "tests/house/include_rules.hpp"
#include "tests/house/include_scanner.hpp"

namespace compueye::house {
namespace {

bool is_project_header(std::string_view header) {
  const auto slash = header.find('/');
  if (slash == std::string_view::npos) return false;
  const std::string_view top = header.substr(0, slash);
  for (const FolderRule& rule : folder_rules()) {
    if (rule.folder.substr(0, rule.folder.find('/')) == top) return true;
  }
  return false;
}

/// Why `include` may not stand in a file of `rule`'s folder; empty when it may.
std::string objection(const Include& include, const FolderRule& rule) {
  const std::string_view header = include.header;
  const std::string against = "; rule: " + std::string(rule.rule);
  if (include.form == Include::Form::macro) return "names its header through a macro, so that nobody can check it";
  if (include.form == Include::Form::quoted && is_project_header(header)) {
    return opens(rule, header) ? "" : "is not open to " + std::string(rule.folder) + against;
  }
  if (const Library* library = library_of_header(header)) {
    const bool allowed = rule.libraries == "*" || has_word(rule.libraries, library->name);
    return allowed ? "" : "belongs to " + std::string(library->name) + against;
  }
  if (include.form == Include::Form::quoted) {
    return "is neither written from the repository root nor a known library (tests/house/include_rules.cpp)";
  }
  if (is_standard_header(header)) return has_word(rule.banned_std, header) ? "is refused here" + against : "";
  if (is_os_header(header)) return rule.os_headers ? "" : "is an OS header" + against;
  return "belongs to no library in tests/house/include_rules.cpp; a new dependency needs a line there and in "
         "docs/dependencies.md";
}

}  // namespace

std::string Violation::text() const {
  return file + ":" + (line > 0 ? std::to_string(line) + ":" : "") + " " + sentence;
}

std::vector<Violation> check_includes(std::string_view file, std::string_view source) {
  const FolderRule* rule = rule_for(file);
  if (rule == nullptr) {
    return {{std::string(file), 0, "lies in a folder without a row in tests/house/include_rules.cpp"}};
  }
  if (rule->project.empty()) return {{std::string(file), 0, "is code; rule: " + std::string(rule->rule)}};

  std::vector<Violation> violations;
  const Library* first_library = nullptr;
  for (const Include& include : scan_includes(source)) {
    const std::string subject = "include of '" + include.header + "' ";
    if (std::string why = objection(include, *rule); !why.empty()) {
      violations.push_back({std::string(file), include.line, subject + why});
      continue;
    }
    const Library* library = library_of_header(include.header);
    if (!rule->one_library_each || library == nullptr) continue;
    if (first_library != nullptr && first_library != library) {
      violations.push_back({std::string(file), include.line,
                            subject + "is a second library beside " + std::string(first_library->name) +
                                "; rule: " + std::string(rule->rule)});
    }
    first_library = library;
  }
  return violations;
}

std::string list(const std::vector<Violation>& violations) {
  std::string text;
  for (const Violation& violation : violations) text += violation.text() + "\n";
  return text;
}

}  // namespace compueye::house
