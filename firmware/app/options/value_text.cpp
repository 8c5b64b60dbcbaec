#include "firmware/app/options/value_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>

namespace compueye::firmware {
namespace {

template <class T>
std::optional<T> whole(std::string_view text) noexcept {
  // from_chars knows no plus sign, but people write one.
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

struct Halves {
  std::string_view first, second;
};

std::optional<Halves> split(std::string_view text, char at) noexcept {
  const auto place = text.find(at);
  if (place == std::string_view::npos) return std::nullopt;
  return Halves{text.substr(0, place), text.substr(place + 1)};
}

}  // namespace

std::optional<double> number_from(std::string_view text) noexcept {
  const auto value = whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long> whole_number_from(std::string_view text) noexcept {
  return whole<long>(text);
}

std::optional<PictureSize> picture_size_from(std::string_view text) noexcept {
  const auto halves = split(text, 'x');
  if (!halves) return std::nullopt;
  const auto rows = whole<int>(halves->first), cols = whole<int>(halves->second);
  if (!rows || !cols || *rows < 1 || *cols < 1) return std::nullopt;
  if (static_cast<std::int64_t>(*rows) * *cols > std::numeric_limits<int>::max()) return std::nullopt;
  return PictureSize{*rows, *cols};
}

std::optional<Interval> interval_from(std::string_view text) noexcept {
  const auto halves = split(text, ',');
  if (!halves) return std::nullopt;
  const auto lo = number_from(halves->first), hi = number_from(halves->second);
  if (!lo || !hi || !(*lo < *hi)) return std::nullopt;
  return Interval{*lo, *hi};
}

}  // namespace compueye::firmware
