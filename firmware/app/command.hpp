#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/app/option_list.hpp"
#include "firmware/app/session.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What a subcommand does once the whole command line is understood.
using Action = std::function<hal::Result<void>(Session&)>;

/// A subcommand, as a row of command_list.cpp.
struct Command {
  std::string_view name;
  std::string_view summary;
  OnSignal on_signal = OnSignal::gives_up;
  /// Adds the command's options, and returns what is done with what they were set to.
  Action (*declare)(OptionList& options) = nullptr;
  /// What --help says below the options; it ends in examples.
  std::string (*footer)() = nullptr;
  /// For programs, such as a shell: --help does not list it.
  bool hidden = false;
};

inline constexpr std::string_view program_summary =
    "The runtime of a computational compound eye: from photodiodes to pictures in real time.";
inline constexpr std::string_view program_example = "compueye run --board boards/sim-8x8 --frames 20";

/// Every subcommand that --help lists, in its order.
[[nodiscard]] std::span<const Command* const> commands() noexcept;
/// The same, and behind them those that are hidden.
[[nodiscard]] std::span<const Command* const> all_commands() noexcept;

/// The action of a command that is a function of what it was asked for.
template <class Request, class Function>
[[nodiscard]] Action action_of(std::shared_ptr<Request> request, Function function) {
  return [request = std::move(request), function](Session& session) { return function(*request, session); };
}

/// A command line, understood.
struct CommandLine {
  /// What it asks for: the command's action, or printing help. Error usage, in one sentence that ends with where to
  /// read on: for an option or a command that does not exist the nearest one that does is suggested, and that comes
  /// before anything that is missing, since a misspelt option is most often the one that is missed.
  hal::Result<Action> action;
  OnSignal on_signal = OnSignal::gives_up;
  bool json = false;         ///< --json is given, to whichever command
  std::string stdout_owner;  ///< see OptionList
};

[[nodiscard]] CommandLine read_command_line(int argc, const char* const* argv,
                                            std::span<const Command* const> commands);

}  // namespace compueye::firmware
