#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/frontend/front_end.hpp"
#include "firmware/eye/board.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// "gpiochip0 5 6 13".
struct LineNames {
  std::string chip;
  std::vector<std::string> lines;
};
/// Nothing where there is no line in it.
[[nodiscard]] std::optional<LineNames> line_names(std::string_view text);

/// What the converters of a board are set to. Errors name the key's place: not_found (a range), out_of_range.
[[nodiscard]] hal::Result<frontend::FrontEndSettings> front_end_settings(const Board& board);

/// That a board of converters says what they need and no other says anything of it; that channels, depth and rate are
/// what the chips have. Errors at the key's place: bad_format, mismatch, out_of_range.
[[nodiscard]] hal::Result<void> check_wiring(const Board& board);

}  // namespace compueye::firmware
