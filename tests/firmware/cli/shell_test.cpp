// What a shell and man are told of the program, and that a program that is installed finds what is installed with it.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/command.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/environment_variable.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::test;

namespace fs = std::filesystem;

namespace {

bool has(const std::vector<std::string>& lines, std::string_view line) {
  return std::find(lines.begin(), lines.end(), line) != lines.end();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// What bash offers for the last of `words`, with the script that the program prints and those boards.
class Shell {
 public:
  Shell() : boards_("COMPUEYE_BOARDS", source_path("boards")), scenes_("COMPUEYE_SCENES", source_path("scenes")) {
    folder_.file("completion", run_compueye("completion bash", folder_.path()).out);
    folder_.file("eye.rec", "");
    fs::create_directory(folder_ / "pictures");
  }

  std::vector<std::string> offers(std::vector<std::string> words) const {
    std::string script = ". ./completion; COMP_WORDS=(compueye";
    for (const std::string& word : words) script += " '" + word + "'";
    script += "); COMP_CWORD=" + std::to_string(words.size()) + "; _compueye '" + compueye_command("run").front() +
              "'; printf '%s\\n' \"${COMPREPLY[@]}\"";
    const Outcome outcome = Program({"/bin/bash", "-u", "-c", script}, folder_.path()).wait();
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.err.empty());
    return lines_of(outcome.out);
  }

 private:
  TemporaryFolder folder_;
  EnvironmentVariable boards_, scenes_;
};

/// A page without the escapes that keep its characters as they are.
std::string plain(const std::string& page) {
  std::string text;
  for (std::size_t i = 0; i < page.size(); ++i) {
    if (page[i] == '\\' && i + 1 < page.size() && page[i + 1] == '-') continue;
    if (page.compare(i, 2, "\\&") == 0 && ++i) continue;
    text += page[i];
  }
  return text;
}

/// The program as a package puts it, with one board.
class Installed {
 public:
  Installed() {
    fs::create_directories(folder_ / "bin");
    fs::create_directories(board());
    fs::create_directories(folder_ / "elsewhere");
    fs::copy_file(compueye_command("run").front(), folder_ / "bin/compueye");
    fs::copy_file(source_path("boards/sim-8x8/board.toml"), board() / "board.toml");
    folder_.file("share/compueye/boards/sim-8x8/.cache", "so that nobody can write what belongs here");
  }

  [[nodiscard]] fs::path board() const { return folder_ / "share/compueye/boards/sim-8x8"; }
  [[nodiscard]] fs::path caches() const { return folder_ / "caches"; }
  [[nodiscard]] Outcome run(const std::vector<std::string>& arguments) const {
    const EnvironmentVariable caches("XDG_CACHE_HOME", this->caches().string()), service("CACHE_DIRECTORY", "");
    std::vector<std::string> all{(folder_ / "bin/compueye").string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return Program(all, folder_ / "elsewhere").wait();
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("bash completes commands, their options, and the words, boards, scenes and files they take") {
  const Shell shell;
  const auto commands = shell.offers({""});
  for (const firmware::Command* command : firmware::commands()) CHECK(has(commands, command->name));
  CHECK_FALSE(has(commands, "completion"));
  CHECK(shell.offers({"si"}) == std::vector<std::string>{"simulate"});
  CHECK(shell.offers({"run", "--boa"}) == std::vector<std::string>{"--board"});
  CHECK(shell.offers({"run", "--json", "--pa"}) == std::vector<std::string>{"--pace"});
  CHECK(shell.offers({"devices", "--boa"}) == std::vector<std::string>{"--boards"});
  CHECK(shell.offers({"run", "--format", "png"}) == std::vector<std::string>{"png", "png16"});
  CHECK(shell.offers({"run", "--format", "=", "np"}) == std::vector<std::string>{"npy"});
  const auto boards = shell.offers({"run", "--board", "sim-8"});
  CHECK(has(boards, "sim-8x8"));
  CHECK(has(boards, "sim-80x80"));
  CHECK_FALSE(has(boards, "generic-usb"));
  CHECK(has(shell.offers({"run", "--board", ""}), "pictures"));
  const auto scenes = shell.offers({"simulate", "--scene", ""});
  CHECK(has(scenes, "phantom"));
  CHECK(has(scenes, "ball.toml"));
  CHECK(shell.offers({"replay", "ey"}) == std::vector<std::string>{"eye.rec"});
  CHECK(shell.offers({"run", "--out", "p"}) == std::vector<std::string>{"pictures"});
  CHECK(shell.offers({"run", "--frames", ""}) == std::vector<std::string>{""});
}

TEST_CASE("bash is offered every option of every command") {
  const Shell shell;
  for (const firmware::Command* command : firmware::commands()) {
    firmware::OptionList options;
    static_cast<void>(command->declare(options));
    const auto offered = shell.offers({std::string(command->name), "--"});
    for (const firmware::Option& option : options.rows()) {
      CAPTURE(option.name);
      CHECK(has(offered, option.name) == option.name.starts_with("--"));
    }
  }
}

TEST_CASE("every command has a page of the manual, with each of its options and what it means") {
  const TemporaryFolder folder;
  const std::string whole = plain(run_compueye("manual", folder.path()).out);
  for (const firmware::Command* command : firmware::commands()) {
    const std::string name(command->name);
    CAPTURE(name);
    CHECK(whole.find("compueye-" + name + " (1)\n") != std::string::npos);
    const Outcome outcome = run_compueye("manual " + name, folder.path());
    CHECK(outcome.exit_code == 0);
    const std::string page = plain(outcome.out);
    CHECK(page.starts_with(".\\\""));
    for (const char* section : {"NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "ENVIRONMENT", "EXAMPLES"}) {
      CHECK(page.find(std::string("\n.SH ") + section + "\n") != std::string::npos);
    }
    CHECK(page.find("  compueye " + name, page.find(".SH EXAMPLES")) != std::string::npos);
    firmware::OptionList options;
    static_cast<void>(command->declare(options));
    for (const firmware::Option& option : options.rows()) {
      CAPTURE(option.name);
      const std::size_t at = page.find("\n.B " + option.name);
      REQUIRE(at != std::string::npos);
      CHECK(page.compare(page.find('\n', at + 1) + 1, 4, plain(option.meaning), 0, 4) == 0);
    }
  }
  CHECK(run_compueye("manual rum", folder.path()).err.find("'run'") != std::string::npos);
}

TEST_CASE("a program that is installed finds its boards by name from anywhere, and keeps what it makes with its user") {
  const Installed installed;
  for (const char* name : {"sim-8x8", "boards/sim-8x8"}) {
    const Outcome run = installed.run({"run", "--board", name, "--frames", "1", "--lossless", "--json"});
    CHECK_MESSAGE(run.exit_code == 0, run.err);
  }
  CHECK(fs::is_regular_file(installed.board() / ".cache"));
  REQUIRE(fs::is_directory(installed.caches() / "compueye"));
  const auto kept = names_in(installed.caches() / "compueye");
  REQUIRE(kept.size() == 1);
  CHECK(kept.front().starts_with("sim-8x8-"));
  CHECK(installed.run({"devices"}).out.find("SIM-8X8") != std::string::npos);

  const Outcome missed = installed.run({"run", "--board", "sim-8x9"});
  CHECK(missed.exit_code == 1);
  const std::string folder = installed.board().parent_path().string();
  CHECK(missed.err.find("did you mean '" + folder + "/sim-8x8'?") != std::string::npos);
  CHECK(missed.err.find("looked in '" + folder + "' too") != std::string::npos);
}

TEST_CASE("scene files are found by name where the environment says, and the nearest is named") {
  const TemporaryFolder folder;
  const EnvironmentVariable told("COMPUEYE_SCENES", source_path("scenes"));
  const std::string begin = "simulate --board " + source_path("boards/sim-8x8") + " --out y.npy --scene ";
  for (const char* name : {"ball", "ball.toml", "scenes/ball.toml"}) {
    CHECK(run_compueye(begin + name, folder.path()).exit_code == 0);
  }
  const Outcome missed = run_compueye(begin + "bal.toml", folder.path());
  CHECK(missed.exit_code == 1);
  CHECK(missed.err.find("'ball.toml'") != std::string::npos);
  CHECK(missed.err.find(source_path("scenes")) != std::string::npos);
}
