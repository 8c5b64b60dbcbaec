#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"

namespace compueye::firmware {

/// What of a board says which eye took a sample, in front of what, and what a code means, a line a setting:
/// "board.eye.rows = 8". Before them "board = NAME", "distance_mm = 10" (which older recordings have alone) and
/// "board_hash = ", sixteen hexadecimal digits of all lines that begin with "board.".
[[nodiscard]] std::string board_lines(const Board& board);

/// What such lines say of a key.
[[nodiscard]] std::optional<std::string> value_in(std::string_view lines, std::string_view key);

/// A setting that was another one then.
struct BoardDifference {
  std::string key;  ///< "eye.rows"
  std::string then;
  std::string now;  ///< either is "left out" where a setting is
};

/// Where `lines`, of a board at another time, differ from `board`. Lines of other keys mean nothing here; settings that
/// `lines` know nothing of count where they know the board at all.
[[nodiscard]] std::vector<BoardDifference> board_differences(std::string_view lines, const Board& board);

/// "eye.rows was 8 and is 9, ...", at most four of them.
[[nodiscard]] std::string text_of(const std::vector<BoardDifference>& differences);

}  // namespace compueye::firmware
