#include "firmware/text/words.hpp"

#include <algorithm>

namespace compueye::firmware {
namespace {

bool continues_code_point(char c) noexcept {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

/// Of the one that `text` begins with; 0: with none. RFC 3629, section 4.
std::size_t code_point_bytes(std::string_view text) noexcept {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
  const unsigned first = byte(0);
  if (first < 0x80U) return 1;
  const std::size_t bytes = first >= 0xC2U && first < 0xE0U   ? 2
                            : first >= 0xE0U && first < 0xF0U ? 3
                            : first >= 0xF0U && first < 0xF5U ? 4
                                                              : 0;
  for (std::size_t k = 1; k < bytes; ++k) {
    if (k >= text.size() || !continues_code_point(text[k])) return 0;
  }
  const bool overlong = (first == 0xE0U && byte(1) < 0xA0U) || (first == 0xF0U && byte(1) < 0x90U);
  const bool beyond = (first == 0xEDU && byte(1) > 0x9FU) || (first == 0xF4U && byte(1) > 0x8FU);
  return overlong || beyond ? 0 : bytes;
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

std::string valid_utf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = code_point_bytes(text.substr(at));
    out += bytes == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(at, bytes);
    at += std::max<std::size_t>(bytes, 1);
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

}  // namespace compueye::firmware
