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
  bool fault = true;  ///< something that went wrong; otherwise what was done about it, or how much it was
};

/// How many things went wrong.
[[nodiscard]] std::uint64_t faults_in(std::span<const Counter> counters) noexcept;

/// "silence 2, restart 2": those that are not 0; empty when all are.
[[nodiscard]] std::string text_of(std::span<const Counter> counters);

}  // namespace compueye::hal
