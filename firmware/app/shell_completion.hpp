#pragma once

#include <span>
#include <string>

#include "firmware/app/command.hpp"

namespace compueye::firmware {

/// A script for bash (4 or newer) that completes the subcommands and options of `compueye`, words where an option takes
/// one of few, boards and scenes by asking the program that is typed, and files or folders of everything else.
[[nodiscard]] std::string bash_completion(std::span<const Command* const> commands);

}  // namespace compueye::firmware
