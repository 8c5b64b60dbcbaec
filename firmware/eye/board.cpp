#include "firmware/eye/board.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "firmware/eye/board_consistency.hpp"
#include "firmware/eye/board_file.hpp"
#include "firmware/eye/settings/board_schema.hpp"
#include "firmware/eye/settings/schema_check.hpp"
#include "firmware/eye/settings/toml_document.hpp"

namespace compueye::firmware {

double SensorSettings::lsb() const noexcept {
  return std::ldexp(full_scale, -bits);
}

double SensorSettings::noise_sigma() const noexcept {
  constexpr double rounding_variance = 1.0 / 12.0;
  return lsb() * std::sqrt(read_noise_lsb * read_noise_lsb + rounding_variance);
}

double Board::noise_sigma() const noexcept {
  return reconstruction.sigma.value_or(sensor.noise_sigma());
}

std::string Board::place(std::string_view section, std::string_view key) const {
  auto found = lines.find(fmt::format("{}.{}", section, key));
  if (found == lines.end()) found = lines.find(std::string(section));
  return found == lines.end() ? file : fmt::format("{}:{}", file, found->second);
}

bool Board::states(std::string_view section, std::string_view key) const {
  return lines.contains(fmt::format("{}.{}", section, key));
}

hal::Result<Board> parse_board(std::string_view text, const std::string& file) {
  auto document = parse_toml(text, file);
  if (!document) return tl::unexpected(document.error());
  if (auto checked = check_against_schema(*document, file); !checked) return tl::unexpected(checked.error());

  Board board;
  board.file = file;
  for (const KeySpec& spec : board_schema()) {
    if (spec.fallback) spec.store(board, *spec.fallback);
  }
  for (const TomlSection& section : document->sections) board.lines.emplace(section.name, section.line);
  for (const TomlEntry& entry : document->entries) {
    board.lines.emplace(entry.section + "." + entry.key, entry.line);
    find_key(entry.section, entry.key)->store(board, entry.value);
  }
  if (board.source.simulated() && board.source.serial.empty()) board.source.serial = "SIM0001";
  if (auto consistent = check_consistency(board); !consistent) return tl::unexpected(consistent.error());
  return board;
}

hal::Result<Board> load_board(const std::filesystem::path& folder) {
  auto file = find_board_file(folder);
  if (!file) return tl::unexpected(file.error());
  auto text = read_board_file(*file);
  if (!text) return tl::unexpected(text.error());
  auto board = parse_board(*text, file->string());
  if (!board) return board;
  board->folder = file->has_parent_path() ? file->parent_path() : std::filesystem::path(".");
  return board;
}

}  // namespace compueye::firmware
