#pragma once

#include <cstdio>
#include <string>

#include "firmware/text/figures.hpp"
#include "hal/accounting.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// produced, delivered, dropped (one member a reason, in the enum's order), balanced
[[nodiscard]] Figures figures_of(const hal::FrameAccount& account);

/// code, place, sentence: what --json prints as the member "error" when a command fails.
[[nodiscard]] Figures figures_of(const hal::Error& error);

/// Writes `text` and flushes. Errors: no_space or io when the file (stdout on a full disk, a closed pipe) refuses it;
/// `name` says which.
[[nodiscard]] hal::Result<void> print_text(const std::string& text, std::FILE* to = stdout,
                                           const std::string& name = "standard output");

/// What the process returns: 2 for a usage error, 1 for every other failure.
[[nodiscard]] int exit_code(const hal::Error& error) noexcept;

/// Writes "compueye: place: sentence" and returns exit_code(), so that main() can end with it. Control characters (a
/// file name may hold a line break or a terminal escape) become visible escapes, so that it is one line whatever it
/// quotes.
int print_error(const hal::Error& error, std::FILE* to = stderr);

}  // namespace compueye::firmware
