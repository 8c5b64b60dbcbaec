#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace compueye::firmware {

// What people and files wrote: shown without harm, and matched with the names that are known.

/// `text` on one line and harmless to a terminal: control characters become \n, \r, \t or \xHH. UTF-8 passes through.
[[nodiscard]] std::string visible_text(std::string_view text);

/// The same, cut after `most` characters (with "..." instead of the rest): for quoting what a file holds.
[[nodiscard]] std::string excerpt(std::string_view text, std::size_t most = 60);

/// Columns a terminal needs for `text`: its UTF-8 code points (wide East Asian characters are not told apart).
[[nodiscard]] std::size_t display_width(std::string_view text) noexcept;

/// Number of single-character insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`
/// (optimal string alignment distance, ASCII case ignored). Only the first 64 characters of each count.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b) noexcept;

/// The known name that `wanted` was most likely meant to be, or nothing when none is near: at most a third of the
/// longer name may differ. The first of equals wins.
[[nodiscard]] std::optional<std::string_view> nearest_name(std::string_view wanted,
                                                           std::span<const std::string_view> known);

/// The end of an error sentence: "; did you mean 'x'?" or, when nothing is near, "; known names are a, b, c" (the
/// first 20), or empty when nothing is known.
[[nodiscard]] std::string suggestion(std::string_view wanted, std::span<const std::string_view> known);

}  // namespace compueye::firmware
