#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "hal/nearest_name.hpp"

namespace compueye::firmware {

// What people and files wrote: shown without harm, and matched with the names that are known.

/// `text` on one line and harmless to a terminal: control characters become \n, \r, \t or \xHH. UTF-8 passes through.
[[nodiscard]] std::string visible_text(std::string_view text);

/// With U+FFFD for every byte that is no part of a code point (RFC 3629): names of files are any bytes.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// The same, cut after `most` characters (with "..." instead of the rest): for quoting what a file holds.
[[nodiscard]] std::string excerpt(std::string_view text, std::size_t most = 60);

/// Columns a terminal needs for `text`: its UTF-8 code points (wide East Asian characters are not told apart).
[[nodiscard]] std::size_t display_width(std::string_view text) noexcept;

using hal::did_you_mean;
using hal::edit_distance;
using hal::nearest_name;
using hal::suggestion;

}  // namespace compueye::firmware
