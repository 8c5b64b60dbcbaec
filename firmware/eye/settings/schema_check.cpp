#include "firmware/eye/settings/schema_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <vector>

#include "firmware/text/nearest_name.hpp"
#include "firmware/text/visible_text.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

std::vector<std::string_view> section_names() {
  std::vector<std::string_view> names;
  for (const SectionSpec& section : board_sections()) names.push_back(section.name);
  return names;
}

std::vector<std::string_view> key_names(std::string_view section) {
  std::vector<std::string_view> names;
  for (const KeySpec& spec : board_schema()) {
    if (spec.section == section) names.push_back(spec.name);
  }
  return names;
}

std::vector<std::string_view> sections_with(std::string_view key) {
  std::vector<std::string_view> names;
  for (const KeySpec& spec : board_schema()) {
    if (spec.name == key) names.push_back(spec.section);
  }
  return names;
}

hal::Error at_line(hal::Error error, const std::string& file, int line) {
  error.place = fmt::format("{}:{}", file, line);
  return error;
}

hal::Result<void> known_section(const TomlSection& section) {
  const std::vector<std::string_view> names = section_names();
  if (std::find(names.begin(), names.end(), section.name) != names.end()) return {};
  return hal::fail(ErrorCode::not_found, {},
                   fmt::format("unknown section [{}]{}", excerpt(section.name), suggestion(section.name, names)));
}

hal::Result<void> known_key(const TomlEntry& entry) {
  if (find_key(entry.section, entry.key) != nullptr) return {};
  const std::string key = excerpt(entry.key);
  const std::vector<std::string_view> elsewhere = sections_with(entry.key);
  const std::string belongs = fmt::format("[{}]", fmt::join(elsewhere, "] or ["));
  if (entry.section.empty()) {
    const std::vector<std::string_view> names = section_names();
    if (std::find(names.begin(), names.end(), entry.key) != names.end()) {
      return hal::fail(
          ErrorCode::bad_format, {},
          fmt::format("'{0}' is {1}, expected one section [{0}] with its keys below", key, quoted(entry.value)));
    }
    if (!elsewhere.empty()) {
      return hal::fail(ErrorCode::not_found, {},
                       fmt::format("key '{}' stands above every section; it belongs in {}", key, belongs));
    }
    return hal::fail(ErrorCode::not_found, {},
                     fmt::format("unknown key '{}' above every section{}", key, suggestion(entry.key, names)));
  }
  const std::vector<std::string_view> names = key_names(entry.section);
  // A misspelling within the section is likelier than a key that strayed here, unless the name is exactly another's.
  const std::string hint =
      elsewhere.empty() ? suggestion(entry.key, names) : fmt::format("; it belongs in {}", belongs);
  return hal::fail(ErrorCode::not_found, {}, fmt::format("unknown key '{}' in [{}]{}", key, entry.section, hint));
}

tl::unexpected<hal::Error> bad_value(const KeySpec& spec, const TomlValue& value, ErrorCode code,
                                     std::string_view remark = {}) {
  return hal::fail(code, {},
                   fmt::format("{} = {} in [{}], expected {}{}", spec.name, quoted(value), spec.section,
                               spec.expectation(), remark));
}

hal::Result<void> check_text(const KeySpec& spec, const TomlValue& value) {
  constexpr std::size_t longest_name = 64, longest_text = 1000;
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) return bad_value(spec, value, ErrorCode::bad_format);
  if (spec.type == ValueType::choice) {
    if (std::find(spec.choices.begin(), spec.choices.end(), *text) != spec.choices.end()) return {};
    const auto near = nearest_name(*text, spec.choices);
    return bad_value(spec, value, ErrorCode::not_found, near ? fmt::format("; did you mean \"{}\"?", *near) : "");
  }
  if (spec.type == ValueType::text) {
    const bool one_line = visible_text(*text) == *text;
    if (one_line && text->size() <= longest_text) return {};
    return bad_value(spec, value, ErrorCode::out_of_range);
  }
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  const bool good =
      !text->empty() && text->size() <= longest_name && plain(text->front()) &&
      std::all_of(text->begin(), text->end(), [&](char c) { return plain(c) || c == '.' || c == '_' || c == '-'; });
  if (good) return {};
  return bad_value(spec, value, ErrorCode::out_of_range);
}

hal::Result<void> check_number(const KeySpec& spec, const TomlValue& value) {
  const auto* whole = std::get_if<std::int64_t>(&value);
  const auto* real = std::get_if<double>(&value);
  if (whole == nullptr && (real == nullptr || spec.type == ValueType::whole)) {
    return bad_value(spec, value, ErrorCode::bad_format);
  }
  const double number = whole != nullptr ? static_cast<double>(*whole) : *real;
  if (!spec.range.holds(number)) return bad_value(spec, value, ErrorCode::out_of_range);
  return {};
}

hal::Result<void> check_whole_list(const KeySpec& spec, const TomlValue& value) {
  const auto* list = std::get_if<std::vector<std::int64_t>>(&value);
  if (list == nullptr) return bad_value(spec, value, ErrorCode::bad_format);
  std::set<std::int64_t> seen;
  for (const std::int64_t item : *list) {
    if (!spec.range.holds(static_cast<double>(item))) {
      return bad_value(spec, value, ErrorCode::out_of_range, fmt::format("; {} is not", item));
    }
    if (!seen.insert(item).second) {
      return bad_value(spec, value, ErrorCode::out_of_range, fmt::format("; {} is there twice", item));
    }
  }
  return {};
}

hal::Result<void> check_real_pair(const KeySpec& spec, const TomlValue& value) {
  std::vector<double> pair;
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&value)) {
    for (const std::int64_t item : *whole) pair.push_back(static_cast<double>(item));
  } else if (const auto* real = std::get_if<std::vector<double>>(&value)) {
    pair = *real;
  } else {
    return bad_value(spec, value, ErrorCode::bad_format);
  }
  if (pair.size() != 2) return bad_value(spec, value, ErrorCode::bad_format);
  if (spec.range.holds(pair[0]) && spec.range.holds(pair[1]) && pair[0] < pair[1]) return {};
  return bad_value(spec, value, ErrorCode::out_of_range);
}

hal::Result<void> nothing_missing(const TomlDocument& document, const std::string& file) {
  for (const KeySpec& spec : board_schema()) {
    if (!spec.required) continue;
    const auto section = std::find_if(document.sections.begin(), document.sections.end(),
                                      [&](const TomlSection& s) { return s.name == spec.section; });
    if (section == document.sections.end()) {
      return hal::fail(ErrorCode::bad_format, file,
                       fmt::format("section [{}] is missing, expected it with at least {} = {}", spec.section,
                                   spec.name, spec.expectation()));
    }
    const bool there = std::any_of(document.entries.begin(), document.entries.end(), [&](const TomlEntry& entry) {
      return entry.section == spec.section && entry.key == spec.name;
    });
    if (!there) {
      return hal::fail(
          ErrorCode::bad_format, fmt::format("{}:{}", file, section->line),
          fmt::format("key '{}' is missing in [{}], expected {}", spec.name, spec.section, spec.expectation()));
    }
  }
  return {};
}

}  // namespace

hal::Result<void> check_value(const KeySpec& spec, const TomlValue& value) {
  switch (spec.type) {
    case ValueType::identifier:
    case ValueType::text:
    case ValueType::choice:
      return check_text(spec, value);
    case ValueType::whole:
    case ValueType::real:
      return check_number(spec, value);
    case ValueType::whole_list:
      return check_whole_list(spec, value);
    case ValueType::real_pair:
      return check_real_pair(spec, value);
  }
  return {};
}

hal::Result<void> check_against_schema(const TomlDocument& document, const std::string& file) {
  for (const TomlSection& section : document.sections) {
    if (auto known = known_section(section); !known) return tl::unexpected(at_line(known.error(), file, section.line));
  }
  for (const TomlEntry& entry : document.entries) {
    if (auto known = known_key(entry); !known) return tl::unexpected(at_line(known.error(), file, entry.line));
    const KeySpec& spec = *find_key(entry.section, entry.key);
    if (auto good = check_value(spec, entry.value); !good) {
      return tl::unexpected(at_line(good.error(), file, entry.line));
    }
  }
  return nothing_missing(document, file);
}

}  // namespace compueye::firmware
