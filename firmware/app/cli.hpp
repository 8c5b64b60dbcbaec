#pragma once

#include <span>

#include "firmware/app/command.hpp"

namespace compueye::firmware {

/// A command line, understood.
struct CommandLine {
  /// What it asks for: the command's action, or printing help. Error usage, in one sentence that ends with where to
  /// read on: for an option or a command that does not exist the nearest one that does is suggested, and that comes
  /// before anything that is missing, since a misspelt option is most often the one that is missed.
  hal::Result<Action> action;
  OnSignal on_signal = OnSignal::ends_the_process;
  bool json = false;  ///< --json is given, to whichever command
};

[[nodiscard]] CommandLine read_command_line(int argc, const char* const* argv,
                                            std::span<const Command* const> commands);

}  // namespace compueye::firmware
