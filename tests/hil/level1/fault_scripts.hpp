#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/protocol/emulator_faults.hpp"

namespace compueye::hil {

/// When and with what a fault of the table happens.
struct FaultMoment {
  std::int64_t at_ns = 0;      ///< in the middle of some frame
  std::uint64_t at_frame = 0;  ///< the frame after that
  std::uint64_t parts = 1;     ///< packets or reports a frame
  std::uint64_t seed = 1;
  const char* serial = "";  ///< of the eye under test
};

/// A row of docs/faults.md as the emulator plays it.
struct FaultScript {
  std::string_view fault;
  std::function<std::vector<protocol::EmulatorFault>(const FaultMoment&)> faults;
  std::int64_t lasts_ns = 0;  ///< from the moment until the device could be right again
};

[[nodiscard]] std::span<const FaultScript> fault_scripts();

}  // namespace compueye::hil
