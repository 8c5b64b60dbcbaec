#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "hal/result.hpp"

namespace compueye::firmware {

/// What the chosen subcommand does once the whole command line is understood.
using Action = std::function<hal::Result<void>()>;

// Each adds its subcommand, with an example in its --help, and sets `chosen` when it is the one.
void add_response_command(CLI::App& app, Action& chosen);
void add_reconstruct_command(CLI::App& app, Action& chosen);
void add_inspect_command(CLI::App& app, Action& chosen);
void add_simulate_command(CLI::App& app, Action& chosen);
void add_run_command(CLI::App& app, Action& chosen);
void add_compare_command(CLI::App& app, Action& chosen);
void add_pareto_command(CLI::App& app, Action& chosen);
void add_devices_command(CLI::App& app, Action& chosen);
void add_record_command(CLI::App& app, Action& chosen);
void add_replay_command(CLI::App& app, Action& chosen);

}  // namespace compueye::firmware
