#pragma once

#include <cstdio>
#include <string>

#include "hal/error.hpp"

namespace compueye::firmware {

/// What the process returns: 2 for a usage error, 1 for every other failure.
[[nodiscard]] int exit_code(const hal::Error& error) noexcept;

/// "compueye: place: sentence" without a line end. Control characters (a file name may hold a line break or a terminal
/// escape) become visible escapes, so that it is one line whatever it quotes.
[[nodiscard]] std::string error_line(const hal::Error& error);

/// Writes error_line() and a line end to `to` and returns exit_code(), so that main() can end with it.
int print_error(const hal::Error& error, std::FILE* to = stderr);

}  // namespace compueye::firmware
