#pragma once

#include <CLI/CLI.hpp>

#include "hal/error.hpp"

namespace compueye::firmware {

/// What CLI11 has to say about a command line, in one sentence that ends with where to read on. For an option or a
/// subcommand that does not exist the nearest one that does is suggested, and that comes before anything that is
/// missing: a misspelt option is most often the one that is missed.
[[nodiscard]] hal::Error usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace compueye::firmware
