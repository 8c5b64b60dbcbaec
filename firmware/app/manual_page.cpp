#include "firmware/app/manual_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <variant>
#include <vector>

namespace compueye::firmware {
namespace {

struct Variable {
  std::string_view name, meaning;
};
constexpr std::array variables{
    Variable{"COMPUEYE_BOARDS",
             "folder in which boards are looked for by name, before those that are installed (../share/compueye/boards "
             "beside the program's folder)"},
    Variable{"COMPUEYE_SCENES", "the same for scene files"},
    Variable{
        "XDG_CACHE_HOME",
        "what takes long to make goes into its folder compueye where the board's folder cannot be written (default: "
        "~/.cache)"},
    Variable{"CACHE_DIRECTORY", "the same, for a service of systemd"},
    Variable{"STATE_DIRECTORY",
             "of a service of systemd: where the eye file that a board names is looked for that does not lie with it"},
};

/// As it stands, whatever roff makes of some characters.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += "\\-";
        break;
      case '\'':
        out += "\\(aq";
        break;
      case '`':
        out += "\\(ga";
        break;
      case '^':
        out += "\\(ha";
        break;
      case '~':
        out += "\\(ti";
        break;
      default:
        out += c;
    }
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string title(const std::string& name) {
  return fmt::format(
      ".\\\" made by `compueye manual` from what --help says\n.TH {} 1 \"\" \"compueye {}\" \"User Commands\"\n",
      escaped(name), COMPUEYE_VERSION);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// What --help says in words and tables: lines that are set in keep their form, all others run on.
std::string prose(std::string_view text) {
  std::string out;
  bool table = false;
  for (std::string_view line : lines_of(text)) {
    const bool set_in = line.starts_with(' ');
    if (set_in != table) out += set_in ? ".PP\n.nf\n" : ".fi\n.PP\n";
    table = set_in;
    out += line.empty() ? ".PP\n" : escaped(line) + "\n";
  }
  return table ? out + ".fi\n" : out;
}

std::string list(const std::vector<std::string>& options) {
  std::string text;
  for (const std::string& option : options) text += (text.empty() ? "" : ", ") + option;
  return text;
}

std::string option_rows(const OptionList& options) {
  std::string out;
  for (const Option& row : options.rows()) {
    const std::string value = value_word(row);
    out += fmt::format(".TP\n.B {}{}\n{}\n", escaped(row.name), value.empty() ? "" : " \\fI" + escaped(value) + "\\fR",
                       escaped(row.meaning));
    if (row.is_required) out += "(required)\n";
    if (!row.needed.empty()) out += fmt::format("(needs {})\n", escaped(list(row.needed)));
    if (!row.excluded.empty()) out += fmt::format("(not with {})\n", escaped(list(row.excluded)));
  }
  return out + ".TP\n.B \\-h\\fR, \\fB\\-\\-help\nprint the same as text and exit\n";
}

std::string environment() {
  std::string out = ".SH ENVIRONMENT\n";
  for (const Variable& each : variables) out += fmt::format(".TP\n.B {}\n{}\n", each.name, escaped(each.meaning));
  return out;
}

/// Words of a command line that need no name, as the synopsis has them.
std::string free_words(const OptionList& options) {
  std::string out;
  for (const Option& row : options.rows()) {
    if (!row.name.starts_with('-')) out += " \\fI" + escaped(row.name) + "\\fR";
  }
  return out;
}

}  // namespace

std::string manual_page(const Command& command) {
  OptionList options;
  static_cast<void>(command.declare(options));
  const std::string name = "compueye-" + std::string(command.name), footer = command.footer();
  const std::size_t examples = std::min(footer.rfind("Example"), footer.size());
  std::string shown = footer.substr(examples);
  shown.erase(0, std::min(shown.find(':') + 1, shown.size()));
  const std::size_t first = shown.find_first_not_of(" \n");
  shown = "  " + shown.substr(first == std::string::npos ? shown.size() : first);
  return title(name) + fmt::format(".SH NAME\n{} \\- {}\n", escaped(name), escaped(command.summary)) +
         fmt::format(".SH SYNOPSIS\n.B compueye {}\n[\\fIoptions\\fR]{}\n", escaped(command.name),
                     free_words(options)) +
         ".SH DESCRIPTION\n" + prose(footer.substr(0, examples)) + ".SH OPTIONS\n" + option_rows(options) +
         environment() + ".SH EXAMPLES\n" + prose(shown) + ".SH SEE ALSO\n.BR compueye (1)\n";
}

std::string manual_page(std::span<const Command* const> commands) {
  std::string rows;
  for (const Command* command : commands) {
    if (command->hidden) continue;
    rows += fmt::format(".TP\n.BR compueye\\-{} (1)\n{}\n", escaped(command->name), escaped(command->summary));
  }
  return title("compueye") + fmt::format(".SH NAME\ncompueye \\- {}\n", escaped(program_summary)) +
         ".SH SYNOPSIS\n.B compueye\n\\fIcommand\\fR [\\fIoptions\\fR]\n.SH DESCRIPTION\n"
         "An eye of photodiodes whose samples overlap is read, its samples are corrected and solved for a picture, and "
         "the "
         "picture is published, frame by frame.\n.SH COMMANDS\n" +
         rows + environment() +
         ".SH EXIT STATUS\n0 it went well, 1 it failed, 2 wrong usage; a command that has others says so.\n" +
         ".SH EXAMPLES\n.nf\n" + escaped(program_example) + "\n.fi\n";
}

}  // namespace compueye::firmware
