#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/devices/device_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

struct DevicesRequest {
  std::string boards = "boards";
};

hal::Result<void> list_devices(const DevicesRequest& request, Session& session) {
  const auto listed = TRY(list_boards(request.boards));
  const AttachedEyes attached = list_attached_eyes(session.clock());
  return session.print(devices_text(attached, request.boards, listed), json_text(devices_json(attached, listed)));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<DevicesRequest>();
  options.add("--boards", o->boards, "folder that holds the boards (default: boards)");
  options.json("print one object and nothing else on stdout");
  return action_of(o, list_devices);
}

std::string footer() {
  return "First the eyes that are attached on USB and HID, with what they say of themselves; an eye that another "
         "program\n"
         "runs cannot be asked. Then the boards, which say what eye they expect; a broken file is listed with what is "
         "wrong.\n\n"
         "Example: compueye devices --boards boards";
}

}  // namespace

extern const Command devices_command;
const Command devices_command{"devices", "which eyes there are", OnSignal::ends_the_process, declare, footer};

}  // namespace compueye::firmware
