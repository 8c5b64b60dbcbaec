#include <memory>
#include <string>

#include "firmware/app/command.hpp"
#include "firmware/app/shell_completion.hpp"
#include "firmware/files/shared_folders.hpp"
#include "sim/pictures/built_in_scenes.hpp"

namespace compueye::firmware {
namespace {

struct CompletionRequest {
  std::string what;
};

std::string lines(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) names.emplace_back(scene.name);
  for (std::string& name : shared_names("scenes")) names.push_back(std::move(name));
  return names;
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command* command : commands()) names.emplace_back(command->name);
  return names;
}

hal::Result<void> complete(const CompletionRequest& o, Session& session) {
  if (o.what == "bash") return session.print(bash_completion(all_commands()));
  if (o.what == "boards") return session.print(lines(shared_names("boards")));
  return session.print(lines(o.what == "scenes" ? scenes() : command_names()));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<CompletionRequest>();
  options.add("what", o->what, "bash: the script; boards, scenes, commands: the names it offers, one a line")
      .required()
      .among({"bash", "boards", "scenes", "commands"});
  return action_of(o, complete);
}

std::string footer() {
  return "Example: compueye completion bash > ~/.local/share/bash-completion/completions/compueye";
}

}  // namespace

extern const Command completion_command;
const Command completion_command{
    "completion", "what a shell asks to complete a command line", OnSignal::gives_up, declare, footer, true};

}  // namespace compueye::firmware
