#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace compueye::hal {

/// Something that happened so many times. Name and meaning outlive every source: literals of a table.
struct Counter {
  std::string_view name;     ///< lower case with '_': a key of JSON and of docs/faults.md
  std::string_view meaning;  ///< for people, no full stop
  std::uint64_t count = 0;
};

/// "silence 2, restart 2": those that are not 0; empty when all are.
[[nodiscard]] std::string text_of(std::span<const Counter> counters);

}  // namespace compueye::hal
