#include <array>

#include "firmware/app/command.hpp"

namespace compueye::firmware {

extern const Command run_command, simulate_command, response_command, reconstruct_command, compare_command,
    pareto_command, stability_command, inspect_command, record_command, replay_command, devices_command,
    conformance_command, calibrate_command, export_command, import_command, doctor_command, completion_command,
    manual_command;

std::span<const Command* const> all_commands() noexcept {
  static constexpr std::array rows{
      &run_command,         &simulate_command,   &response_command,  &reconstruct_command, &compare_command,
      &pareto_command,      &stability_command,  &calibrate_command, &inspect_command,     &import_command,
      &export_command,      &record_command,     &replay_command,    &devices_command,     &doctor_command,
      &conformance_command, &completion_command, &manual_command,
  };
  return rows;
}

std::span<const Command* const> commands() noexcept {
  constexpr std::size_t hidden = 2;
  return all_commands().first(all_commands().size() - hidden);
}

}  // namespace compueye::firmware
