#include <doctest/doctest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "recon/solver_list.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

/// A command of a fenced block, and why it is not run; empty: it is.
struct Command {
  std::string text;
  std::string not_run;
};

/// "<!-- not run: BEGIN OF A COMMAND: WHY -->" before a block holds for the one command in it that begins so.
struct NotRun {
  std::string begin, why;
  int commands = 0;
};

NotRun marked(std::string_view line) {
  constexpr std::string_view lead = "<!-- not run: ", end = " -->";
  REQUIRE(line.ends_with(end));
  line = line.substr(lead.size(), line.size() - lead.size() - end.size());
  const std::size_t colon = line.find(": ");
  CAPTURE(line);
  REQUIRE(colon != std::string_view::npos);
  return {std::string(line.substr(0, colon)), std::string(line.substr(colon + 2))};
}

/// Every command of the page's fenced blocks that name no language, in their order.
[[maybe_unused]] std::vector<Command> commands_of(const std::string& page) {
  std::ifstream file(source_path(page));
  REQUIRE(file);
  std::vector<Command> commands;
  std::vector<NotRun> marks;
  std::string line, begun;
  bool fenced = false, other = false;
  while (std::getline(file, line)) {
    if (!fenced && line.starts_with("<!-- not run: ")) marks.push_back(marked(line));
    if (line.starts_with("```")) {
      fenced = !fenced;
      other = fenced && line != "```";
      for (const NotRun& mark : marks) {
        if (fenced) break;
        CAPTURE(mark.begin);
        CHECK(mark.commands == 1);
      }
      if (!fenced) marks.clear();
    } else if (fenced && !other && !line.empty()) {
      const bool goes_on = line.ends_with('\\');
      begun += goes_on ? line.substr(0, line.size() - 1) : line;
      if (goes_on) continue;
      Command command{std::move(begun), {}};
      begun.clear();
      for (NotRun& mark : marks) {
        if (!command.text.starts_with(mark.begin)) continue;
        ++mark.commands;
        command.not_run = mark.why;
      }
      commands.push_back(std::move(command));
    }
  }
  CHECK(begun.empty());
  return commands;
}

}  // namespace

TEST_CASE("every command of the README does what it says, in the order in which it stands there") {
#if defined(NDEBUG) && !defined(COMPUEYE_NO_MULTIVERSION)
  const TemporaryFolder folder;
  std::filesystem::copy(source_path("scenes"), folder / "scenes");
  std::filesystem::create_directory(folder / "boards");
  for (const auto& board : std::filesystem::directory_iterator(source_path("boards"))) {
    // Without what was kept there by others.
    if (!std::filesystem::exists(board.path() / "board.toml")) continue;
    std::filesystem::create_directory(folder / "boards" / board.path().filename());
    for (const auto& file : std::filesystem::directory_iterator(board.path())) {
      if (file.path().extension() != ".toml") continue;
      std::filesystem::copy_file(file.path(), folder / "boards" / board.path().filename() / file.path().filename());
    }
  }
  int run = 0;
  for (const Command& command : commands_of("README.md")) {
    if (!command.not_run.empty()) continue;
    CAPTURE(command.text);
    const std::string shell = "compueye() { '" + compueye_command("").front() + "' \"$@\"; }\n" + command.text;
    const Outcome outcome = Program({"/bin/sh", "-c", shell}, folder.path()).wait();
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 0);
    ++run;
  }
  CHECK(run >= 15);
#else
  std::puts("SKIPPED: takes minutes without optimisation or with a sanitizer");
#endif
}

TEST_CASE("the README names every solver there is") {
  const std::string page = bytes_of(source_path("README.md"));
  for (const recon::SolverKind solver : recon::solvers()) {
    CAPTURE(solver->name);
    CHECK(page.find("`" + std::string(solver->name) + "`") != std::string::npos);
  }
}
