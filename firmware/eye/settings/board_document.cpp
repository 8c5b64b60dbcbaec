#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/settings/toml_document.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

std::vector<std::string_view> section_names() {
  std::vector<std::string_view> names;
  for (const Section& section : sections()) names.push_back(section.name);
  return names;
}

std::vector<std::string_view> key_names(std::string_view section) {
  std::vector<std::string_view> names;
  for (const Setting& setting : settings()) {
    if (setting.section == section) names.push_back(setting.key);
  }
  return names;
}

std::vector<std::string_view> sections_with(std::string_view key) {
  std::vector<std::string_view> names;
  for (const Setting& setting : settings()) {
    if (setting.key == key && !setting.section.empty()) names.push_back(setting.section);
  }
  return names;
}

hal::Result<void> known_section(const TomlSection& section) {
  const std::vector<std::string_view> names = section_names();
  if (std::find(names.begin(), names.end(), section.name) != names.end()) return {};
  return hal::fail(ErrorCode::not_found, {},
                   fmt::format("unknown section [{}]{}", excerpt(section.name), suggestion(section.name, names)));
}

hal::Result<void> known_key(const TomlEntry& entry) {
  if (find_setting(entry.section, entry.key) != nullptr) return {};
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

hal::Result<void> nothing_missing(const TomlDocument& document, const std::string& file) {
  for (const Setting& setting : settings()) {
    if (!setting.required) continue;
    const auto section = std::find_if(document.sections.begin(), document.sections.end(),
                                      [&](const TomlSection& s) { return s.name == setting.section; });
    if (section == document.sections.end()) {
      return hal::fail(ErrorCode::bad_format, file,
                       fmt::format("section [{}] is missing, expected it with at least {} = {}", setting.section,
                                   setting.key, setting.expectation()));
    }
    const bool there = std::any_of(document.entries.begin(), document.entries.end(), [&](const TomlEntry& entry) {
      return entry.section == setting.section && entry.key == setting.key;
    });
    if (!there) {
      return hal::fail(
          ErrorCode::bad_format, fmt::format("{}:{}", file, section->line),
          fmt::format("key '{}' is missing in [{}], expected {}", setting.key, setting.section, setting.expectation()));
    }
  }
  return {};
}

/// Every key of the document is known, is of the right type and in range, and no required key is missing. One fault is
/// reported: the first unknown section, else the first bad line, else the first missing key (last, so that a misspelt
/// key is told as that).
hal::Result<void> check_document(const TomlDocument& document, const std::string& file) {
  const auto at_line = [&](int line) {
    return [&file, line](hal::Error error) {
      error.place = fmt::format("{}:{}", file, line);
      return error;
    };
  };
  for (const TomlSection& section : document.sections) TRY(known_section(section).map_error(at_line(section.line)));
  for (const TomlEntry& entry : document.entries) {
    const auto good_value = [&] {
      return check_value(*find_setting(entry.section, entry.key), entry.value, entry.written);
    };
    TRY(known_key(entry).and_then(good_value).map_error(at_line(entry.line)));
  }
  return nothing_missing(document, file);
}

}  // namespace

hal::Result<Board> parse_board(std::string_view text, const std::string& file) {
  const TomlDocument document = TRY(parse_toml(text, file));
  TRY(check_document(document, file));
  Board board;
  board.file = file;
  for (const Setting& setting : settings()) {
    if (setting.fallback) setting.store(board, *setting.fallback);
  }
  const auto at = [&](int line) { return fmt::format("{}:{}", file, line); };
  for (const TomlSection& section : document.sections) board.places.emplace(section.name, at(section.line));
  for (const TomlEntry& entry : document.entries) {
    board.places.emplace(entry.section + "." + entry.key, at(entry.line));
    find_setting(entry.section, entry.key)->store(board, entry.value);
  }
  if (board.source.simulated() && board.source.serial.empty()) board.source.serial = "SIM0001";
  TRY(check_board(board));
  return board;
}

}  // namespace compueye::firmware
