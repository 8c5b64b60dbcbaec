#include "firmware/text/number_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace compueye::firmware {
namespace {

constexpr int most_digits = 17;

std::string not_a_number(double value) {
  if (std::isnan(value)) return "n/a";
  return value > 0.0 ? "inf" : "-inf";
}

template <class T>
std::optional<T> typed(std::string_view text) noexcept {
  // from_chars knows no plus sign, but people write one.
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return not_a_number(value);
  std::string text = fmt::format("{:.{}f}", value, std::clamp(decimals, 0, most_digits));
  if (text.front() == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return not_a_number(value);
  if (value == 0.0) return "0";
  const int kept = std::clamp(digits, 1, most_digits);
  const std::string scientific = fmt::format("{:.{}e}", value, kept - 1);
  // The exponent after rounding: 0.9996 with three digits is 1.00, not 1.000.
  const int exponent = std::atoi(scientific.c_str() + scientific.find('e') + 1);
  constexpr int least_exponent = -4, most_exponent = 5;
  if (exponent < least_exponent || exponent > most_exponent) return scientific;
  return fixed(value, std::max(0, kept - 1 - exponent));
}

std::string grouped(std::int64_t value) {
  std::string text = fmt::format("{}", value);
  const std::size_t first = value < 0 ? 1 : 0;
  for (std::size_t at = text.size(); at > first + 3;) {
    at -= 3;
    text.insert(at, 1, ',');
  }
  return text;
}

std::string duration(double seconds) {
  constexpr double longest = 1e9;
  if (!(seconds >= 0.0 && seconds < longest)) return "n/a";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string bytes(std::uint64_t count) {
  constexpr std::array<std::string_view, 6> units{"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  if (count < 1024) return fmt::format("{} B", count);
  double value = static_cast<double>(count) / 1024.0;
  std::size_t unit = 0;
  while (value >= 1023.5 && unit + 1 < units.size()) {
    value /= 1024.0;
    ++unit;
  }
  return fmt::format("{} {}", significant(value, value >= 999.5 ? 4 : 3), units[unit]);
}

std::optional<double> typed_number(std::string_view text) noexcept {
  const auto value = typed<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> typed_whole_number(std::string_view text) noexcept {
  return typed<std::int64_t>(text);
}

}  // namespace compueye::firmware
