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

std::uint64_t count_of(const std::vector<hal::Counter>& failures, const std::string& counter) {
  for (const hal::Counter& each : failures) {
    if (each.name == counter) return each.count;
  }
  FAIL("docs/faults.md names a counter that is not there: " << counter);
  return 0;
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

void check_drops(const hal::FrameAccount& account, const ExpectedOutcome& expected) {
  for (std::size_t k = 0; k < hal::drop_reason_count; ++k) {
    const std::string reason(hal::name(static_cast<hal::DropReason>(k)));
    const bool allowed =
        reason == "stopped" || std::find(expected.drops.begin(), expected.drops.end(), reason) != expected.drops.end();
    CAPTURE(reason);
    CHECK((allowed || account.dropped[k] == 0));
  }
}

void check_counters(const std::vector<hal::Counter>& failures, const ExpectedOutcome& expected) {
  for (const auto& one_of : expected.counters) {
    std::uint64_t moved = 0;
    for (const std::string& counter : one_of) moved += count_of(failures, counter);
    CAPTURE(one_of.front());
    CHECK(moved > 0);
  }
  if (expected.counters.empty()) CHECK(hal::text_of(failures).empty());
}

}  // namespace compueye::hil
