#pragma once

#include <cstdio>
#include <string>

#include "firmware/text/figures.hpp"
#include "hal/accounting.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// One object of the members, whose keys keep their order. Valid whatever they hold: NaN and infinity become null,
/// bytes that are not UTF-8 (file names) become U+FFFD. Two blanks of indentation, one line end.
[[nodiscard]] std::string json_text(const Figures& figures);

/// produced, delivered, dropped (one member a reason, in the enum's order), balanced
[[nodiscard]] Figures figures_of(const hal::FrameAccount& account);

/// code, place, sentence: what --json prints as the member "error" when a command fails.
[[nodiscard]] Figures figures_of(const hal::Error& error);

/// The object that `json` is the text of, with the member "error": how a report tells what went wrong after it.
[[nodiscard]] std::string with_error(const std::string& json, const hal::Error& error);

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
