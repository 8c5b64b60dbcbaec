#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/counter.hpp"

namespace compueye::device {

/// How often each row of a table of counters has happened; `Which` numbers the rows.
template <class Which, const auto& rows>
class CounterSet {
 public:
  std::uint64_t& operator[](Which which) noexcept { return counts_[static_cast<std::size_t>(which)]; }
  std::uint64_t operator[](Which which) const noexcept { return counts_[static_cast<std::size_t>(which)]; }

  /// All of those that are no deeds.
  [[nodiscard]] std::uint64_t faults() const noexcept {
    std::uint64_t faults = 0;
    for (std::size_t k = 0; k < counts_.size(); ++k) faults += rows[k].fault ? counts_[k] : 0;
    return faults;
  }

  /// All of them, with their names.
  [[nodiscard]] std::vector<hal::Counter> counters() const {
    std::vector<hal::Counter> counters(rows.begin(), rows.end());
    for (std::size_t k = 0; k < counters.size(); ++k) counters[k].count = counts_[k];
    return counters;
  }

 private:
  std::array<std::uint64_t, rows.size()> counts_{};
};

}  // namespace compueye::device
