#pragma once

#include <optional>
#include <string>

namespace compueye::firmware {

/// The first line of a file of the system, without its end; nothing where it cannot be read.
[[nodiscard]] std::optional<std::string> first_line(const std::string& path);

/// The number that it begins with, in C's notation: 0x50005 too.
[[nodiscard]] std::optional<long> number_in(const std::string& path);

}  // namespace compueye::firmware
