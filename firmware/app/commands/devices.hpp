#pragma once

#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/source_list.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A folder with a board file: what it describes, or why it cannot be read.
struct ListedBoard {
  std::string folder;
  hal::Result<Board> board;
};

/// Every folder below `boards` that holds a board.toml, by name. Errors: not_found, io.
[[nodiscard]] hal::Result<std::vector<ListedBoard>> list_boards(const std::string& boards);

/// What is attached, and the boards below `boards`.
[[nodiscard]] Figures devices_report(const AttachedEyes& attached, const std::string& boards,
                                     const std::vector<ListedBoard>& listed);

}  // namespace compueye::firmware
