#include "firmware/eye/board_wiring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <sstream>

#include "firmware/eye/source_kinds.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// A key that a chip needs, or has no use for.
Result<void> check_key(const Board& board, std::string_view key, bool given, bool needed, std::string_view why) {
  if (given == needed) return {};
  return fail(ErrorCode::mismatch, board.place("wiring", given ? key : "chip"),
              needed ? fmt::format("{} in [wiring] needs {}, since {}; state it", board.wiring.chip, key, why)
                     : fmt::format("{} in [wiring] means nothing to {}; remove the line", key, board.wiring.chip));
}

/// One line, or with `many` any number.
Result<void> check_lines(const Board& board, std::string_view key, const std::string& text, bool many) {
  if (text.empty()) return {};
  const auto names = line_names(text);
  if (names && (many || names->lines.size() == 1) && names->lines.size() <= 32) return {};
  return fail(ErrorCode::bad_format, board.place("wiring", key),
              fmt::format("{} in [wiring] is \"{}\", expected the chip and the line{}, \"gpiochip0 17\"", key, text,
                          many ? "s, at most 32" : ""));
}

Result<void> check_size(const Board& board, const frontend::FrontEndRow& chip) {
  const int channels = chip.channels * board.wiring.chips, ommatidia = board.eye.ommatidia();
  if (channels != ommatidia) {
    return fail(ErrorCode::mismatch, board.place("wiring", "chips"),
                fmt::format("chips = {} of {} in [wiring] have {} channels, the eye has {} ommatidia",
                            board.wiring.chips, chip.name, channels, ommatidia));
  }
  if (chip.bits != board.sensor.bits) {
    return fail(ErrorCode::mismatch, board.place("sensor", "bits"),
                fmt::format("bits = {} in [sensor], but {} gives {}", board.sensor.bits, chip.name, chip.bits));
  }
  std::vector<int> sorted = board.wiring.ommatidia;
  std::ranges::sort(sorted);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (sorted.size() == static_cast<std::size_t>(ommatidia) && sorted[k] == static_cast<int>(k)) continue;
    return fail(
        ErrorCode::mismatch, board.place("wiring", "ommatidia"),
        fmt::format("ommatidia in [wiring] names {}, expected each from 0 to {} once", sorted.size(), ommatidia - 1));
  }
  return {};
}

}  // namespace

std::optional<LineNames> line_names(std::string_view text) {
  std::istringstream words{std::string(text)};
  LineNames names;
  words >> names.chip;
  for (std::string line; words >> line;) names.lines.push_back(line);
  return names.lines.empty() ? std::nullopt : std::optional(std::move(names));
}

Result<frontend::FrontEndSettings> front_end_settings(const Board& board) {
  const frontend::FrontEndRow& chip = *frontend::find_front_end(board.wiring.chip);
  frontend::FrontEndSettings settings;
  settings.chips = board.wiring.chips;
  settings.clock_hz = static_cast<std::uint32_t>(board.wiring.clock_hz);
  settings.frame_rate_hz = board.source.frame_rate_hz;
  if (board.wiring.range.empty()) return settings;
  std::string known;
  for (std::size_t k = 0; k < chip.ranges.size(); ++k) {
    if (chip.ranges[k].name == board.wiring.range) {
      settings.range = static_cast<int>(k);
      return settings;
    }
    known += fmt::format("{}\"{}\"", k == 0 ? "" : ", ", chip.ranges[k].name);
  }
  return fail(ErrorCode::not_found, board.place("wiring", "range"),
              fmt::format("range in [wiring] is \"{}\", expected {}", board.wiring.range,
                          known.empty() ? "none, since the chip has one range" : "one of " + known));
}

Result<void> check_wiring(const Board& board) {
  const WiringSettings& wiring = board.wiring;
  if (!board.source.wired()) {
    if (!board.places.contains("wiring")) return {};
    return fail(ErrorCode::mismatch, board.place("wiring", ""),
                "[wiring] is of kind = \"spi\" in [source]; set that or remove the section");
  }
  if (wiring.chip.empty() || wiring.data.empty()) {
    return fail(ErrorCode::bad_format, board.place("source", "kind"),
                "kind = \"spi\" in [source] needs a section [wiring] with chip and data");
  }
  const frontend::FrontEndRow& chip = *frontend::find_front_end(wiring.chip);
  const bool addressed = !chip.chain && wiring.chips > 1;
  TRY(check_key(board, "data_ready", !wiring.data_ready.empty(), chip.data_ready, "the chip sets the pace"));
  TRY(check_key(board, "settings", !wiring.settings.empty(), chip.settings_bus, "settings have wires of their own"));
  TRY(check_key(board, "select", !wiring.select.empty(), addressed, "each of its chips has an address"));
  TRY(check_lines(board, "data_ready", wiring.data_ready, false));
  TRY(check_lines(board, "select", wiring.select, true));
  TRY(check_lines(board, "reset", wiring.reset, false));
  TRY(check_lines(board, "sync", wiring.sync, false));
  TRY(check_size(board, chip));
  auto made = chip.make(TRY(front_end_settings(board)));
  if (made) return {};
  return fail(made.error().code, board.place("wiring", "chip"), made.error().text());
}

}  // namespace compueye::firmware
