#include <fmt/format.h>

#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "firmware/eye/settings/document_rules.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/settings/toml_document.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

DocumentRules board_rules() {
  DocumentRules rules{sections(), {}};
  for (const Setting& setting : settings()) {
    if (!setting.section.empty()) rules.keys.push_back(&setting);
  }
  return rules;
}

}  // namespace

hal::Result<Board> parse_board(std::string_view text, const std::string& file) {
  const TomlDocument document = TRY(parse_toml(text, file));
  TRY(check_document(document, board_rules(), file));
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
