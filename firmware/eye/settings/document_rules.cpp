#include "firmware/eye/settings/document_rules.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

std::vector<std::string_view> section_names(const DocumentRules& rules) {
  std::vector<std::string_view> names;
  for (const Section& section : rules.sections) names.push_back(section.name);
  return names;
}

std::vector<std::string_view> key_names(const DocumentRules& rules, std::string_view section) {
  std::vector<std::string_view> names;
  for (const SettingRule* rule : rules.keys) {
    if (rule->section == section) names.push_back(rule->key);
  }
  return names;
}

std::vector<std::string_view> sections_with(const DocumentRules& rules, std::string_view key) {
  std::vector<std::string_view> names;
  for (const SettingRule* rule : rules.keys) {
    if (rule->key == key) names.push_back(rule->section);
  }
  return names;
}

/// As the file writes it: [eye], [[surface]].
std::string heading(const Section& section) {
  return section.repeats ? fmt::format("[[{}]]", section.name) : fmt::format("[{}]", section.name);
}

const Section* section_named(const DocumentRules& rules, std::string_view name) {
  const auto at = std::find_if(rules.sections.begin(), rules.sections.end(),
                               [&](const Section& section) { return section.name == name; });
  return at == rules.sections.end() ? nullptr : &*at;
}

hal::Result<void> known_section(const DocumentRules& rules, const TomlSection& section) {
  const Section* known = section_named(rules, section.name);
  if (known == nullptr) {
    return hal::fail(
        ErrorCode::not_found, {},
        fmt::format("unknown section [{}]{}", excerpt(section.name), suggestion(section.name, section_names(rules))));
  }
  if (known->repeats == section.listed) return {};
  return hal::fail(ErrorCode::bad_format, {},
                   known->repeats
                       ? fmt::format("'{0}' is one section, expected [[{0}]], one for each", known->name)
                       : fmt::format("'{0}' is a list of sections, expected one section [{0}]", known->name));
}

hal::Result<void> known_key(const DocumentRules& rules, const TomlEntry& entry) {
  if (rules.find(entry.section, entry.key) != nullptr) return {};
  const std::string key = excerpt(entry.key);
  const std::vector<std::string_view> elsewhere = sections_with(rules, entry.key);
  const std::string belongs = fmt::format("[{}]", fmt::join(elsewhere, "] or ["));
  if (entry.section.empty()) {
    if (const Section* meant = section_named(rules, entry.key)) {
      return hal::fail(ErrorCode::bad_format, {},
                       fmt::format("'{}' is {}, expected {} {} with its keys below", key, quoted(entry.value),
                                   meant->repeats ? "sections" : "one section", heading(*meant)));
    }
    if (!elsewhere.empty()) {
      return hal::fail(ErrorCode::not_found, {},
                       fmt::format("key '{}' stands above every section; it belongs in {}", key, belongs));
    }
    return hal::fail(
        ErrorCode::not_found, {},
        fmt::format("unknown key '{}' above every section{}", key, suggestion(entry.key, section_names(rules))));
  }
  // A misspelling within the section is likelier than a key that strayed here, unless the name is exactly another's.
  const std::string hint = elsewhere.empty() ? suggestion(entry.key, key_names(rules, entry.section))
                                             : fmt::format("; it belongs in {}", belongs);
  return hal::fail(ErrorCode::not_found, {}, fmt::format("unknown key '{}' in [{}]{}", key, entry.section, hint));
}

hal::Result<void> nothing_missing(const DocumentRules& rules, const TomlDocument& document, const std::string& file) {
  for (const SettingRule* rule : rules.keys) {
    if (!rule->required) continue;
    bool any = false;
    for (const TomlSection& section : document.sections) {
      if (section.name != rule->section) continue;
      any = true;
      const bool there = std::any_of(document.entries.begin(), document.entries.end(), [&](const TomlEntry& entry) {
        return entry.section == rule->section && entry.number == section.number && entry.key == rule->key;
      });
      if (there) continue;
      return hal::fail(
          ErrorCode::bad_format, fmt::format("{}:{}", file, section.line),
          fmt::format("key '{}' is missing in [{}], expected {}", rule->key, rule->section, rule->expectation()));
    }
    if (any) continue;
    return hal::fail(ErrorCode::bad_format, file,
                     fmt::format("section {} is missing, expected it with at least {} = {}",
                                 heading(*section_named(rules, rule->section)), rule->key, rule->expectation()));
  }
  return {};
}

}  // namespace

const SettingRule* DocumentRules::find(std::string_view section, std::string_view key) const noexcept {
  for (const SettingRule* rule : keys) {
    if (rule->section == section && rule->key == key) return rule;
  }
  return nullptr;
}

hal::Result<void> check_document(const TomlDocument& document, const DocumentRules& rules, const std::string& file) {
  const auto at_line = [&](int line) {
    return [&file, line](hal::Error error) {
      error.place = fmt::format("{}:{}", file, line);
      return error;
    };
  };
  for (const TomlSection& section : document.sections) {
    TRY(known_section(rules, section).map_error(at_line(section.line)));
  }
  for (const TomlEntry& entry : document.entries) {
    const auto good_value = [&] {
      return check_value(*rules.find(entry.section, entry.key), entry.value, entry.written);
    };
    TRY(known_key(rules, entry).and_then(good_value).map_error(at_line(entry.line)));
  }
  return nothing_missing(rules, document, file);
}

}  // namespace compueye::firmware
