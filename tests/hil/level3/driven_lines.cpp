#include "tests/hil/level3/driven_lines.hpp"

#include <charconv>
#include <optional>
#include <string>

namespace compueye::hil {
namespace {

std::optional<int> number_behind(std::string_view line, std::string_view word) {
  const std::size_t at = line.find(word);
  if (at == std::string_view::npos) return std::nullopt;
  int value = 0;
  const std::string_view digits = line.substr(at + word.size());
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return read.ec == std::errc{} ? std::optional(value) : std::nullopt;
}

}  // namespace

std::uint32_t driven_number(std::string_view debug_gpio, std::string_view chip, std::span<const std::string> lines) {
  std::uint32_t number = 0;
  std::optional<int> base;  // of the chip whose lines these are, where it is ours
  while (!debug_gpio.empty()) {
    const std::size_t end = debug_gpio.find('\n');
    const std::string_view line = debug_gpio.substr(0, end);
    debug_gpio.remove_prefix(end == std::string_view::npos ? debug_gpio.size() : end + 1);
    if (line.starts_with("gpiochip")) {
      base = line.starts_with(std::string(chip) + ":") ? number_behind(line, "GPIOs ") : std::nullopt;
      continue;
    }
    const auto global = number_behind(line, " gpio-");
    if (!base || !global || line.find(") out hi") == std::string_view::npos) continue;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (lines[k] == std::to_string(*global - *base)) number |= 1U << k;
    }
  }
  return number;
}

}  // namespace compueye::hil
