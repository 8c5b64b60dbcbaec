#include "firmware/app/recording/replay.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"

namespace compueye::firmware {

void add_replay_command(CLI::App& app, Action& chosen) {
  auto o = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand("replay", "what is in a recording, frame by frame, and what is missing");
  command->add_option("file", o->file, "the recording, such as eye.rec")->required();
  command->add_flag("--json", o->json, "print one object with every figure and nothing else on stdout");
  command->footer(
      "Reads every block and checks it: description, frames, gaps and their reasons, damage, torn tail. A damaged "
      "recording is reported with exit code 0; exit code 1 is for one that cannot be read at all. `compueye run "
      "--replay` makes pictures of it.\n\n"
      "Examples:\n"
      "  compueye replay eye.rec\n"
      "  compueye run --board boards/sim-8x8 --replay eye.rec --out pictures");
  command->callback([o, &chosen] { chosen = [o] { return with_json_failure(o->json, replay(*o)); }; });
}

}  // namespace compueye::firmware
