#pragma once

#include <doctest/doctest.h>

#include <charconv>
#include <cstddef>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/source_folder.hpp"

/// A page of docs/ that specifies bytes, so that a test can hold the code to its tables and worked examples.
namespace compueye::tests {

using Row = std::vector<std::string>;

inline unsigned number_in(std::string text) {
  const bool hex = text.starts_with("0x");
  if (hex) text.erase(0, 2);
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, hex ? 16 : 10);
  CAPTURE(text);
  REQUIRE(error == std::errc());
  REQUIRE(end == text.data() + text.size());
  return value;
}

/// "31 32", "32 times FF" or "(none)".
inline std::vector<std::byte> bytes_in(const std::string& text) {
  if (const auto times = text.find(" times "); times != std::string::npos) {
    return std::vector<std::byte>(number_in(text.substr(0, times)), bytes_in(text.substr(times + 7)).at(0));
  }
  std::istringstream words(text);
  std::vector<std::byte> bytes;
  for (std::string word; words >> word && word != "(none)";) {
    bytes.push_back(static_cast<std::byte>(number_in("0x" + word)));
  }
  return bytes;
}

class Page {
 public:
  /// `name`: of a page in docs/.
  explicit Page(const std::string& name) {
    std::ifstream file(test::source_path("docs/" + name));
    REQUIRE(file);
    std::string line, heading, block;
    while (std::getline(file, line)) {
      if (line.starts_with("```")) {
        block = line.starts_with("```hex ") ? line.substr(7) : std::string();
      } else if (!block.empty()) {
        const auto more = bytes_in(line);
        hex_[block].insert(hex_[block].end(), more.begin(), more.end());
      } else if (line.starts_with("#")) {
        heading = line.substr(line.find(' ') + 1);
      } else if (line.starts_with("| ")) {
        tables_[heading].push_back(cells(line));
      }
    }
  }
  [[nodiscard]] const std::vector<std::byte>& hex(const std::string& name) const {
    CAPTURE(name);
    REQUIRE(hex_.contains(name));
    return hex_.at(name);
  }
  /// All rows below a heading, the titles of each table among them.
  [[nodiscard]] const std::vector<Row>& rows(const std::string& heading) const {
    CAPTURE(heading);
    REQUIRE(tables_.contains(heading));
    return tables_.at(heading);
  }
  /// The table of bytes below a heading leaves no byte out; its length.
  [[nodiscard]] unsigned described_bytes(const std::string& heading) const {
    unsigned next = 0;
    bool in_table = false;
    for (const Row& row : rows(heading)) {
      if (row[0] == "offset") {
        in_table = true;
      } else if (in_table && row[0].find_first_not_of("0123456789") == std::string::npos) {
        CAPTURE(row[2]);
        CHECK(number_in(row[0]) == next);
        next += number_in(row[1]);
      } else {
        in_table = false;
      }
    }
    return next;
  }

 private:
  static Row cells(const std::string& line) {
    Row row;
    for (std::size_t at = 2; at < line.size();) {
      const std::size_t end = line.find('|', at);
      std::string cell = line.substr(at, end - at);
      std::erase(cell, '`');
      while (!cell.empty() && cell.back() == ' ') cell.pop_back();
      row.push_back(cell);
      at = end == std::string::npos ? line.size() : end + 2;
    }
    return row;
  }

  std::map<std::string, std::vector<std::byte>> hex_;
  std::map<std::string, std::vector<Row>> tables_;
};

}  // namespace compueye::tests
