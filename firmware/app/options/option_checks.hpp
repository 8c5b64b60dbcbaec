#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace compueye::firmware {

// Checks of option values whose message says what was given and what was expected; CLI11's own say neither.

/// A finite number for which `accepts` is true; `expected` continues "is 'x', expected".
[[nodiscard]] CLI::Validator number_where(std::function<bool(double)> accepts, std::string expected);

/// A whole number from `least` to `most`.
[[nodiscard]] CLI::Validator whole_number(long least, long most);

/// One of `known`. Names in `later` are announced but do not exist yet, which the message says; for any other name the
/// nearest known one is suggested.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string_view> known, std::vector<std::string_view> later);

/// A text for which `complaint` returns an empty string.
[[nodiscard]] CLI::Validator text_where(std::function<std::string(const std::string&)> complaint);

}  // namespace compueye::firmware
