#include "firmware/app/reconstruct/reconstruct.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"

namespace compueye::firmware {

void add_reconstruct_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ReconstructOptions>();
  CLI::App* command = app.add_subcommand("reconstruct", "samples y and a response A become pictures x");
  add_reconstruct_options(*command, *options);
  command->footer(reconstruct_footer());
  command->callback(
      [options, &chosen] { chosen = [options] { return with_json_failure(options->json, reconstruct(*options)); }; });
}

}  // namespace compueye::firmware
