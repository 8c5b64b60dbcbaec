#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/command.hpp"
#include "firmware/app/manual_page.hpp"
#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

struct ManualRequest {
  std::string command;
};

hal::Result<void> print_page(const ManualRequest& o, Session& session) {
  if (o.command.empty()) return session.print(manual_page(commands()));
  std::vector<std::string_view> names;
  for (const Command* command : commands()) {
    if (command->name == o.command) return session.print(manual_page(*command));
    names.push_back(command->name);
  }
  return hal::fail(hal::ErrorCode::not_found, excerpt(o.command), "is not a command" + suggestion(o.command, names));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ManualRequest>();
  options.add("command", o->command, "whose page (default: the program's)");
  return action_of(o, print_page);
}

std::string footer() {
  return "Example: compueye manual run | man -l -";
}

}  // namespace

extern const Command manual_command;
const Command manual_command{"manual", "a page of the manual, for man", OnSignal::gives_up, declare, footer, true};

}  // namespace compueye::firmware
