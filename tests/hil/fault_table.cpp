#include "tests/hil/fault_table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <charconv>
#include <fstream>

namespace compueye::hil {
namespace {

std::string trimmed(std::string text) {
  std::erase(text, '`');
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> split(std::string_view text, std::string_view separator) {
  std::vector<std::string> parts;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    parts.push_back(trimmed(std::string(text.substr(at, end - at))));
    if (end == text.size()) return parts;
    at = end + separator.size();
  }
}

/// "none" is no word.
std::vector<std::string> words(const std::string& cell) {
  return cell == "none" ? std::vector<std::string>() : split(cell, ",");
}

ExpectedOutcome parse_row(const std::string& line) {
  const std::vector<std::string> cells = split(line.substr(1, line.rfind('|') - 1), "|");
  CAPTURE(line);
  REQUIRE(cells.size() == 6);
  ExpectedOutcome row{cells[0], cells[1], cells[2], 0, {}, words(cells[5])};
  const auto [end, error] = std::from_chars(cells[3].data(), cells[3].data() + cells[3].size(), row.bound_ms);
  REQUIRE(error == std::errc());
  REQUIRE(end == cells[3].data() + cells[3].size());
  for (const std::string& counter : words(cells[4])) row.counters.push_back(split(counter, " or "));
  return row;
}

}  // namespace

std::vector<ExpectedOutcome> read_fault_table(const std::string& path) {
  std::ifstream file(path);
  REQUIRE(file);
  std::vector<ExpectedOutcome> rows;
  bool in_table = false;
  int titles = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) in_table = line == "## The table";
    if (!in_table || !line.starts_with('|')) continue;
    if (titles++ < 2) continue;
    ExpectedOutcome row = parse_row(line);
    if (row.bus != "both") {
      rows.push_back(row);
      continue;
    }
    for (const char* bus : {"usb", "hid"}) {
      row.bus = bus;
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace compueye::hil
