#include <algorithm>
#include <array>

#include "drivers/frontend/ads131m08.hpp"
#include "drivers/frontend/ads8688.hpp"
#include "drivers/frontend/ddc264.hpp"
#include "drivers/frontend/front_end.hpp"
#include "drivers/frontend/front_end_faults.hpp"
#include "drivers/frontend/mcp3208.hpp"

namespace compueye::frontend {

std::string_view name(ChipFault fault) noexcept {
  static constexpr std::array<std::string_view, chip_fault_count> names{
      "none", "crc_error", "wrong_place", "stuck_low", "stuck_high", "lost_settings", "no_new_sample"};
  return names[static_cast<std::size_t>(fault)];
}

std::string_view name(FrontEndFaultKind kind) noexcept {
  static constexpr std::array<std::string_view, front_end_fault_kind_count> names{
      "edges_stuck", "edges_missed",  "edges_unqueued", "edges_doubled", "edge_storm", "select_glitch",
      "clock_lost",  "clock_doubled", "bit_error",      "miso_low",      "miso_high",  "bus_error",
      "answer_lost", "slow_bus",      "clock_drift",    "other_chip",    "brown_out",  "gone"};
  return names[static_cast<std::size_t>(kind)];
}

std::span<const FrontEndRow* const> front_ends() noexcept {
  static constexpr std::array rows{
      &mcp3208,
      &ads8688,
      &ads131m08,
      &ddc264,
  };
  return rows;
}

const FrontEndRow* find_front_end(std::string_view name) noexcept {
  const auto rows = front_ends();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const FrontEndRow* row) { return row->name == name; });
  return found == rows.end() ? nullptr : *found;
}

}  // namespace compueye::frontend
