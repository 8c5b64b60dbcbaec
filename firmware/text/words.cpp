#include "firmware/text/words.hpp"

#include <algorithm>
#include <array>

namespace compueye::firmware {
namespace {

bool continues_code_point(char c) noexcept {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

constexpr std::size_t longest = 64;
constexpr std::size_t most_listed = 20;

char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::string visible_text(std::string_view text) {
  constexpr std::string_view hex = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '\n') {
      out += "\\n";
    } else if (c == '\r') {
      out += "\\r";
    } else if (c == '\t') {
      out += "\\t";
    } else if (code < 0x20U || code == 0x7FU) {
      out += "\\x";
      out += hex[code >> 4U];
      out += hex[code & 0xFU];
    } else {
      out += c;
    }
  }
  return out;
}

std::string excerpt(std::string_view text, std::size_t most) {
  std::size_t end = 0;
  for (std::size_t points = 0; end < text.size(); ++end) {
    if (!continues_code_point(text[end]) && points++ == most) break;
  }
  return visible_text(text.substr(0, end)) + (end < text.size() ? "..." : "");
}

std::size_t display_width(std::string_view text) noexcept {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !continues_code_point(c); }));
}

std::size_t edit_distance(std::string_view a, std::string_view b) noexcept {
  a = a.substr(0, longest);
  b = b.substr(0, longest);
  using Row = std::array<std::size_t, longest + 1>;
  Row before{}, above{}, row{};
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0U : 1U)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = above;
    above = row;
  }
  return above[b.size()];
}

std::optional<std::string_view> nearest_name(std::string_view wanted, std::span<const std::string_view> known) {
  std::optional<std::string_view> best;
  std::size_t best_distance = 0;
  for (const std::string_view name : known) {
    const std::size_t distance = edit_distance(wanted, name);
    const std::size_t allowed = std::max<std::size_t>(1, std::max(wanted.size(), name.size()) / 3);
    // A wholly different short name is within the allowance but is no help.
    if (distance > allowed || distance >= std::max(wanted.size(), name.size())) continue;
    if (!best || distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view wanted, std::span<const std::string_view> known) {
  if (known.empty()) return {};
  if (const auto near = nearest_name(wanted, known)) return "; did you mean '" + std::string(*near) + "'?";
  std::string text = known.size() == 1 ? "; the only known name is " : "; known names are ";
  for (std::size_t n = 0; n < std::min(known.size(), most_listed); ++n) {
    if (n > 0) text += ", ";
    text += known[n];
  }
  if (known.size() > most_listed) text += ", ...";
  return text;
}

}  // namespace compueye::firmware
