#include "firmware/app/inspect/duplicate_rows.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace compueye::firmware {
namespace {

using Row = std::vector<std::pair<std::int32_t, double>>;

void take_row(const recon::Response& response, int m, Row& row) {
  row.clear();
  response.for_each_in_row(m, [&](std::int32_t n, double value) {
    if (value != 0.0) row.emplace_back(n, value);
  });
}

/// Mixes as FNV-1a does, a number at a time.
std::uint64_t hash_of(const Row& row) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  const auto mix = [&hash](std::uint64_t bits) {
    hash = (hash ^ bits) * 0x100000001B3U;
    hash ^= hash >> 29U;
  };
  for (const auto& [column, value] : row) {
    mix(static_cast<std::uint64_t>(column));
    mix(std::bit_cast<std::uint64_t>(value));
  }
  return hash;
}

}  // namespace

int count_duplicate_rows(const recon::Response& response) {
  std::unordered_map<std::uint64_t, std::vector<int>> first_rows;
  Row row, other;
  int duplicates = 0;
  for (int m = 0; m < response.rows(); ++m) {
    take_row(response, m, row);
    if (row.empty()) continue;
    std::vector<int>& alike = first_rows[hash_of(row)];
    const bool seen = std::any_of(alike.begin(), alike.end(), [&](int earlier) {
      take_row(response, earlier, other);
      return other == row;
    });
    if (seen) {
      ++duplicates;
    } else {
      alike.push_back(m);
    }
  }
  return duplicates;
}

}  // namespace compueye::firmware
