#include <filesystem>
#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/devices/device_list.hpp"

namespace compueye::firmware {
namespace {

struct DevicesOptions {
  std::filesystem::path boards = "boards";
  bool json = false;
};

hal::Result<void> list_devices(const DevicesOptions& options) {
  const auto listed = list_boards(options.boards);
  if (!listed) return tl::unexpected(listed.error());
  hal::MonotonicClock clock;
  const AttachedEyes attached = list_attached_eyes(clock);
  return print_text(options.json ? json_text(devices_json(attached, *listed))
                                 : devices_text(attached, options.boards, *listed));
}

}  // namespace

void add_devices_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DevicesOptions>();
  CLI::App* command = app.add_subcommand("devices", "which eyes there are");
  command->add_option("--boards", options->boards, "folder that holds the boards (default: boards)");
  command->add_flag("--json", options->json, "print one object and nothing else on stdout");
  command->footer(
      "First the eyes that are attached on USB and HID, with what they say of themselves; an eye that another program\n"
      "runs cannot be asked. Then the boards, which say what eye they expect; a broken file is listed with what is "
      "wrong.\n\n"
      "Example: compueye devices --boards boards");
  command->callback([options, &chosen] { chosen = [options] { return list_devices(*options); }; });
}

}  // namespace compueye::firmware
