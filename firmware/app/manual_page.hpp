#pragma once

#include <span>
#include <string>

#include "firmware/app/command.hpp"

namespace compueye::firmware {

/// compueye(1), for man: what the program is for, a line a command, its environment, its exit codes. In roff, man(7).
[[nodiscard]] std::string manual_page(std::span<const Command* const> commands);

/// compueye-NAME(1): the rows of which --help is made.
[[nodiscard]] std::string manual_page(const Command& command);

}  // namespace compueye::firmware
