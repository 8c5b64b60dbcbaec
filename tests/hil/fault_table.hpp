#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/accounting.hpp"
#include "hal/counter.hpp"

/// docs/faults.md as the ladder reads it: what is expected is written there and nowhere else.
namespace compueye::hil {

/// One row of the table.
struct ExpectedOutcome {
  std::string fault;
  std::string bus;                                 ///< "usb" or "hid"; a row for both comes twice
  std::string outcome;                             ///< "recovered", "degraded and flagged" or "stopped safely"
  std::int64_t bound_ms = 0;                       ///< from the end of the fault to frames or to the end
  std::vector<std::vector<std::string>> counters;  ///< of each at least one must have moved
  std::vector<std::string> drops;                  ///< reasons for which frames may be dropped
};

/// Reads the table below the heading "The table"; a row that does not parse is a failed test.
[[nodiscard]] std::vector<ExpectedOutcome> read_fault_table(const std::string& path);

/// Frames are missing for reasons of the row alone, beside `stopped`.
void check_drops(const hal::FrameAccount& account, const ExpectedOutcome& expected);
/// Each counter that the row names has moved; where it names none, none has.
void check_counters(const std::vector<hal::Counter>& failures, const ExpectedOutcome& expected);

}  // namespace compueye::hil
