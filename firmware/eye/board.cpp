#include "firmware/eye/board.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/settings/toml_document.hpp"
#include "firmware/eye/source_kinds.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

bool SourceSettings::simulated() const noexcept {
  return bus_of_kind(kind) == nullptr;
}

double Board::noise_sigma() const noexcept {
  return sigma.value_or(sensor.noise_sigma());
}

std::string Board::cache() const {
  return (std::filesystem::path(folder) / ".cache").string();
}

std::string Board::place(std::string_view section, std::string_view key) const {
  auto found = places.find(fmt::format("{}.{}", section, key));
  if (found == places.end()) found = places.find(std::string(section));
  return found == places.end() ? file : found->second;
}

bool Board::states(std::string_view section, std::string_view key) const {
  return places.contains(fmt::format("{}.{}", section, key));
}

bool Board::overrules(std::string_view section, std::string_view key) const {
  return states(section, key) && place(section, key).starts_with("--");
}

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
