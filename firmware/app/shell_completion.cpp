#include "firmware/app/shell_completion.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>
#include <variant>
#include <vector>

namespace compueye::firmware {
namespace {

constexpr std::string_view before = R"(# Completion of compueye for bash, made by `compueye completion bash`.
_compueye() {
  local program=$1 current=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD - 1]} command='' options='' word
  # --option=value comes as three words.
  [[ $current != = ]] || current=''
  [[ $last != = || COMP_CWORD -lt 2 ]] || last=${COMP_WORDS[COMP_CWORD - 2]}
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ $word == -* ]] || { command=$word && break; }
  done
  COMPREPLY=()
)";

constexpr std::string_view after = R"(  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options --help" -- "$current")
    return
  fi
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -f -- "$current")
}
complete -F _compueye compueye
)";

/// What stands for a value: code that fills COMPREPLY. Empty: a file, as is offered where nothing else is known.
std::string offer(const Option& option) {
  constexpr std::string_view words = "mapfile -t COMPREPLY < <(compgen -W \"{}\" -- \"$current\")";
  constexpr std::string_view folders =
      "compopt -o filenames 2>/dev/null; mapfile -O ${#COMPREPLY[@]} -t COMPREPLY < <(compgen -d -- \"$current\")";
  constexpr std::string_view files =
      "compopt -o filenames 2>/dev/null; mapfile -O ${#COMPREPLY[@]} -t COMPREPLY < <(compgen -f -- \"$current\")";
  const auto asked = [&](std::string_view what) {
    return fmt::format(fmt::runtime(words), fmt::format("$(\"$program\" completion {} 2>/dev/null)", what));
  };
  if (option.name == "--board") return fmt::format("{}\n      {}", asked("boards"), folders);
  if (option.name == "--scene") return fmt::format("{}\n      {}", asked("scenes"), files);
  if (!option.words.empty()) return fmt::format(fmt::runtime(words), fmt::join(option.words, " "));
  if (option.writes == Writes::folder) return std::string(folders);
  const auto* target = std::get_if<Target>(&option.target);
  const bool text = target != nullptr && (std::holds_alternative<std::string*>(*target) ||
                                          std::holds_alternative<std::optional<std::string>*>(*target));
  return text ? "" : ":";
}

void add_command(const Command& command, std::string& options, std::map<std::string, std::string>& patterns) {
  OptionList rows;
  static_cast<void>(command.declare(rows));
  std::string names;
  for (const Option& row : rows.rows()) {
    if (!row.name.starts_with("--")) continue;
    names += (names.empty() ? "" : " ") + row.name;
    if (std::holds_alternative<Switch>(row.target)) continue;
    const std::string offered = offer(row);
    if (offered.empty()) continue;
    std::string& pattern = patterns[offered];
    pattern += fmt::format("{}'{} {}'", pattern.empty() ? "" : " | ", command.name, row.name);
  }
  options += fmt::format("    {}) options='{}' ;;\n", command.name, names);
}

}  // namespace

std::string bash_completion(std::span<const Command* const> commands) {
  std::string names, options;
  std::map<std::string, std::string> patterns;  // what is offered -> the options for which it is
  for (const Command* command : commands) {
    if (command->hidden) continue;
    names += std::string(command->name) + " ";
    add_command(*command, options, patterns);
  }
  std::string values;
  for (const auto& [offered, pattern] : patterns)
    values += fmt::format("    {})\n      {}\n      return\n      ;;\n", pattern, offered);
  return std::string(before) + "  if [[ -z $command ]]; then\n    mapfile -t COMPREPLY < <(compgen -W \"" + names +
         "--help --version\" -- \"$current\")\n    return\n  fi\n  case $command in\n" + options +
         "  esac\n  case \"$command $last\" in\n" + values + "  esac\n" + std::string(after);
}

}  // namespace compueye::firmware
