#include "firmware/eye/board_lamps.hpp"

#include <fmt/format.h>

#include "firmware/eye/board_wiring.hpp"

namespace compueye::firmware {

using hal::ErrorCode;
using hal::fail;

hal::Result<void> check_lamps(const Board& board) {
  constexpr std::size_t most_lines = 32;
  const std::string& text = board.lamps.lines;
  if (!board.places.contains("lamps")) return {};
  if (board.source.simulated()) {
    return fail(ErrorCode::mismatch, board.place("lamps", ""),
                "[lamps] light real eyes, and the board's is simulated; remove the section");
  }
  if (text.empty()) {
    return fail(ErrorCode::bad_format, board.place("lamps", ""), "[lamps] needs lines, \"gpiochip0 5 6 13 19\"");
  }
  const auto names = line_names(text);
  if (!names || names->lines.size() > most_lines) {
    return fail(ErrorCode::bad_format, board.place("lamps", "lines"),
                fmt::format("lines in [lamps] is \"{}\", expected the chip and its lines, at most {}, "
                            "\"gpiochip0 5 6 13 19\"",
                            text, most_lines));
  }
  const int pixels = board.object.rows * board.object.cols;
  if (names->lines.size() == static_cast<std::size_t>(pixels)) return {};
  return fail(
      ErrorCode::mismatch, board.place("lamps", "lines"),
      fmt::format("lines in [lamps] are {}, expected {}, one for each pixel of [object]", names->lines.size(), pixels));
}

}  // namespace compueye::firmware
