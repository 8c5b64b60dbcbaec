#include "firmware/app/options/usage_error.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/text/nearest_name.hpp"
#include "firmware/text/visible_text.hpp"

namespace compueye::firmware {
namespace {

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::string unknown(std::string_view what, const std::string& given, const std::vector<std::string>& known) {
  const std::vector<std::string_view> views(known.begin(), known.end());
  const std::string name = given.substr(0, given.find('='));
  return "'" + excerpt(name) + "' is not " + std::string(what) + suggestion(name, views);
}

/// Empty when every option and subcommand is known.
std::string unknown_name(const CLI::App& app, const CLI::App& command) {
  const std::vector<std::string> extras = app.remaining(true);
  const auto option =
      std::find_if(extras.begin(), extras.end(), [](const std::string& e) { return e.starts_with("-"); });
  if (option != extras.end()) return unknown("an option", *option, option_names(command));
  if (&command == &app && !extras.empty()) return unknown("a command", extras.front(), command_names(app));
  return {};
}

}  // namespace

hal::Error usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string path = "compueye";
  for (const CLI::App* sub : app.get_subcommands()) {
    command = sub;
    path += " " + sub->get_name();
  }
  std::string sentence = unknown_name(app, *command);
  if (sentence.empty()) sentence = error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  return {hal::ErrorCode::usage, {}, sentence + "; see " + path + " --help"};
}

}  // namespace compueye::firmware
