#include "firmware/eye_page/plots/markup.hpp"

#include <cstdint>

#include "firmware/text/words.hpp"

namespace compueye::firmware {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : visible_text(valid_utf8(text))) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string png_data_uri(std::span<const std::byte> png) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = "data:image/png;base64,";
  out.reserve(out.size() + png.size() / 3 * 4 + 4);
  for (std::size_t at = 0; at < png.size(); at += 3) {
    const std::size_t there = std::min<std::size_t>(3, png.size() - at);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < there ? std::to_integer<std::uint32_t>(png[at + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += k <= there ? digits[bits >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return out;
}

std::string figures_line(std::string_view sentence) {
  std::string text(sentence);
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z')
    text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return "<p class=\"figures\">" + escaped(text) + ".</p>\n";
}

std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows,
                       std::size_t numbers) {
  std::string out = "<table><thead><tr>";
  const auto cell = [&](std::string_view tag, std::size_t column, const std::string& text) {
    const bool number = column + numbers >= head.size();
    out +=
        "<" + std::string(tag) + (number ? " class=\"number\">" : ">") + escaped(text) + "</" + std::string(tag) + ">";
  };
  for (std::size_t c = 0; c < head.size(); ++c) cell("th", c, head[c]);
  out += "</tr></thead>\n<tbody>";
  for (const std::vector<std::string>& row : rows) {
    out += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) cell("td", c, row[c]);
    out += "</tr>\n";
  }
  return out + "</tbody></table>\n";
}

}  // namespace compueye::firmware
