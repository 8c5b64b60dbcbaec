#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace compueye::hal {

/// Number of single-character insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`
/// (optimal string alignment distance, ASCII case ignored). Only the first 64 characters of each count.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b) noexcept;

/// The known name that `wanted` was most likely meant to be, or nothing when none is near: at most a third of the
/// longer name may differ. The first of equals wins.
[[nodiscard]] std::optional<std::string_view> nearest_name(std::string_view wanted,
                                                           std::span<const std::string_view> known);

/// The end of an error sentence that has named all that is known: "; did you mean 'x'?", or empty when none is near.
[[nodiscard]] std::string did_you_mean(std::string_view wanted, std::span<const std::string_view> known);

/// The end of an error sentence that has not: "; did you mean 'x'?" or, when nothing is near, "; known names are a, b,
/// c" (the first 20), or empty when nothing is known.
[[nodiscard]] std::string suggestion(std::string_view wanted, std::span<const std::string_view> known);

}  // namespace compueye::hal
