#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace compueye::hil {

/// The number that output lines of a GPIO chip drive, the first line being the lowest bit, out of what the kernel tells
/// of all of them (/sys/kernel/debug/gpio). A line that is an input, or that nobody has, counts as low.
[[nodiscard]] std::uint32_t driven_number(std::string_view debug_gpio, std::string_view chip,
                                          std::span<const std::string> lines);

}  // namespace compueye::hil
