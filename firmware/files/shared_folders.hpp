#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace compueye::firmware {

// Boards and scenes that belong to the machine, as a package installs them: they are asked for by name, from anywhere.

/// Where those of a kind ("boards", "scenes") lie, in the order in which they are looked for: the folder that
/// COMPUEYE_BOARDS (COMPUEYE_SCENES) names, if it is set, then ../share/compueye/<kind> beside the folder of this
/// program's file. Neither need exist.
[[nodiscard]] std::vector<std::string> shared_folders(std::string_view kind);

/// What lies in them, in alphabetical order: folders with a board.toml, and of other kinds the files in TOML, as they
/// are asked for by name.
[[nodiscard]] std::vector<std::string> shared_names(std::string_view kind);

/// The name that `given` stands for where it is no path that leads anywhere: "sim-8x8" of "sim-8x8", and of
/// "boards/sim-8x8" too, so that what is typed in the project's folder can be typed everywhere. Nothing of other paths.
[[nodiscard]] std::optional<std::string> shared_name(const std::string& given, std::string_view kind);

/// `given` as it is where there is such a file or folder, or where no shared folder has one of its name; else the first
/// that has.
[[nodiscard]] std::string given_or_shared(const std::string& given, std::string_view kind);

/// "; looked in 'A' and 'B' too" for an error about a name, which is empty for other paths.
[[nodiscard]] std::string shared_folders_searched(const std::string& given, std::string_view kind);

}  // namespace compueye::firmware
