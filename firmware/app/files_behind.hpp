#pragma once

#include <string>
#include <vector>

namespace compueye::firmware {

/// The files that a command reads for an option's value `given`: the file, or the board.toml of the folder, of that
/// name or of the machine's board or scene that it stands for; and what a TOML file among them names, such as a board's
/// default scene and a scene's pictures. Files that do not exist are left out; none is refused here.
[[nodiscard]] std::vector<std::string> files_behind(const std::string& given);

}  // namespace compueye::firmware
