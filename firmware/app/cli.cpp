#include "firmware/app/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

template <class T>
constexpr bool is_list = std::is_same_v<T, std::vector<std::string>> || std::is_same_v<T, std::vector<double>>;

CLI::Option* add(CLI::App& app, const Option& row, const Target& target) {
  return std::visit(
      [&](auto* value) {
        CLI::Option* option = app.add_option(row.name, *value, row.meaning);
        if constexpr (is_list<std::remove_pointer_t<decltype(value)>>) option->delimiter(',');
        return option;
      },
      target);
}

CLI::Option* add(CLI::App& app, const Option& row, const Switch& flag) {
  return app.add_flag_callback(
      row.name, [flag] { std::visit([&](auto* target) { *target = flag.value; }, flag.target); }, row.meaning);
}

void add(CLI::App& app, const OptionList& options) {
  for (const Option& row : options.rows()) {
    CLI::Option* option = std::visit([&](const auto& target) { return add(app, row, target); }, row.target);
    if (const std::string word = value_word(row); !word.empty()) option->type_name(word);
    if (row.check) option->check(CLI::Validator([check = row.check](std::string& text) { return check(text); }, ""));
    option->required(row.is_required);
    for (const std::string& other : row.excluded) option->excludes(app.get_option(other));
    for (const std::string& other : row.needed) option->needs(app.get_option(other));
  }
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// What was given at which place, and what is wrong with it.
struct Complaint {
  std::string place, sentence;
};

Complaint unknown(std::string_view what, const std::string& given, const std::vector<std::string>& known) {
  const std::vector<std::string_view> views(known.begin(), known.end());
  const std::string name = given.substr(0, given.find('='));
  return {excerpt(name), "is not " + std::string(what) + suggestion(name, views)};
}

/// Nothing when every option and command is known.
std::optional<Complaint> unknown_name(const CLI::App& app, const CLI::App& command,
                                      std::span<const Command* const> commands) {
  const std::vector<std::string> extras = app.remaining(true);
  const auto dashed = [](const std::string& word) { return word.starts_with("-"); };
  const auto word = std::find_if_not(extras.begin(), extras.end(), dashed);
  if (&command == &app && word != extras.end()) {
    std::vector<std::string> names;
    for (const Command* each : commands) {
      if (!each->hidden) names.emplace_back(each->name);
    }
    return unknown("a command", *word, names);
  }
  const auto option = std::find_if(extras.begin(), extras.end(), dashed);
  if (option == extras.end()) return std::nullopt;
  return unknown("an option", *option, option_names(command));
}

/// CLI11 says which option it means in its sentence only, and mostly begins with it: "--lambda excludes --sigma".
Complaint complaint_of(std::string_view sentence, const CLI::App& command) {
  std::string place;
  std::size_t first = std::string_view::npos;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    const std::size_t at = sentence.find(name);
    // Of two that begin alike the longer one is meant.
    if (at == std::string_view::npos || at > first || (at == first && name.size() < place.size())) continue;
    place = name;
    first = at;
  }
  if (first == 0) {
    sentence.remove_prefix(place.size());
    sentence.remove_prefix(std::min(sentence.find_first_not_of(": "), sentence.size()));
  }
  return {place, std::string(sentence)};
}

hal::Error usage_error(const CLI::App& app, const CLI::ParseError& error, std::span<const Command* const> commands) {
  const CLI::App* command = &app;
  std::string path = "compueye";
  for (const CLI::App* sub : app.get_subcommands()) {
    command = sub;
    path += " " + sub->get_name();
  }
  const auto stranger = unknown_name(app, *command, commands);
  auto [place, sentence] = stranger ? *stranger : complaint_of(error.what(), *command);
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  return {hal::ErrorCode::usage, place, sentence + "; see " + path + " --help"};
}

/// --help and --version end the parsing as if they were errors.
Action print_instead(const CLI::App& app, const CLI::ParseError& asked) {
  std::ostringstream text;
  app.exit(asked, text, text);
  return [text = text.str()](Session& session) { return session.print(text); };
}

}  // namespace

CommandLine read_command_line(int argc, const char* const* argv, std::span<const Command* const> commands) {
  CLI::App app{std::string(program_summary)};
  app.set_version_flag("--version", COMPUEYE_VERSION);
  app.require_subcommand(1);
  app.footer("Example: " + std::string(program_example) + "\nEvery subcommand has its own --help.");
  CommandLine line{Action{}, {}, false, {}};
  std::deque<OptionList> options;
  for (const Command* command : commands) {
    CLI::App* sub = app.add_subcommand(std::string(command->name), std::string(command->summary));
    if (command->hidden) sub->group("");
    OptionList& list = options.emplace_back();
    Action action = command->declare(list);
    add(*sub, list);
    sub->footer(command->footer());
    sub->callback([&line, &list, command, action = std::move(action)] {
      const auto owner = list.stdout_owner();
      line = {action, command->on_signal, list.wants_json(), owner.value_or("")};
      if (!owner) line.action = tl::unexpected(owner.error());
    });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return {print_instead(app, error), OnSignal::gives_up, false, {}};
    const bool json = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
    return {tl::unexpected(usage_error(app, error, commands)), OnSignal::gives_up, json, {}};
  }
  return line;
}

}  // namespace compueye::firmware
