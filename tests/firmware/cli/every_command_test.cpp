// What holds for every subcommand, whatever it does: the rows of firmware::commands().

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "firmware/app/command.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

/// A command line that is understood and then fails, and the place that its error names.
struct Failing {
  std::string arguments;
  std::string place;
};
const std::map<std::string_view, Failing> failing{
    {"run", {"--board missing", "missing"}},
    {"simulate", {"--board missing --out z.npy", "missing"}},
    {"response", {"--board missing", "missing"}},
    {"reconstruct", {"--response missing.npy --samples y.npy --size 2x2 --sigma 1", "missing.npy"}},
    {"compare", {"--board missing", "missing"}},
    {"pareto", {"--board missing", "missing"}},
    {"stability", {"--board missing", "missing"}},
    {"calibrate", {"--board missing --eye z.eye", "missing"}},
    {"inspect", {"missing.npy", "missing.npy"}},
    {"import", {"A.npy --board missing --eye z.eye", "missing"}},
    {"export", {"missing.eye --out z.npy", "missing.eye"}},
    {"record", {"--board missing --out z.rec", "missing"}},
    {"replay", {"missing.rec", "missing.rec"}},
    {"devices", {"--boards missing", "missing"}},
    {"doctor", {"--board missing", "missing"}},
    {"conformance", {"--bus hid --serial missing", "missing"}},
};

std::vector<firmware::Option> options_of(const firmware::Command& command) {
  firmware::OptionList options;
  static_cast<void>(command.declare(options));
  return {options.rows().begin(), options.rows().end()};
}

/// The error object on stdout, whose sentence is on stderr too.
nlohmann::json error_of(const Outcome& outcome, int exit_code) {
  CAPTURE(outcome.out);
  CAPTURE(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
  REQUIRE(json.is_object());
  REQUIRE(json.size() == 1);
  const nlohmann::json error = json["error"];
  for (const char* member : {"code", "place", "sentence"}) REQUIRE(error[member].is_string());
  CHECK(outcome.err.starts_with("compueye: "));
  CHECK(outcome.err.find(error["sentence"].get<std::string>()) != std::string::npos);
  return error;
}

}  // namespace

TEST_CASE("every command shows how it is used: each option, and an example") {
  const ScratchProblem problem;
  const Outcome all = run_compueye("--help", problem.folder().path());
  CHECK(all.exit_code == 0);
  std::set<std::string_view> names;
  for (const firmware::Command* command : firmware::commands()) {
    CAPTURE(command->name);
    CHECK(names.insert(command->name).second);
    CHECK(all.out.find(command->summary) != std::string::npos);
    const Outcome help = run_compueye(std::string(command->name) + " --help", problem.folder().path());
    CHECK(help.exit_code == 0);
    CHECK(help.err.empty());
    CHECK(std::none_of(help.out.begin(), help.out.end(), [](char c) { return c != '\n' && (c < ' ' || c > '~'); }));
    const std::size_t examples = help.out.find("Example");
    REQUIRE(examples != std::string::npos);
    CHECK(help.out.find("compueye " + std::string(command->name), examples) != std::string::npos);
    for (const firmware::Option& option : options_of(*command)) {
      CAPTURE(option.name);
      CHECK(help.out.find("  " + option.name) != std::string::npos);
      CHECK(option.meaning.size() > 5);
    }
  }
}

TEST_CASE("every command refuses an option that it has not, and a value where a number is wanted") {
  const ScratchProblem problem;
  for (const firmware::Command* command : firmware::commands()) {
    CAPTURE(command->name);
    check_refused(problem, std::string(command->name) + " --nonsense", hal::ErrorCode::usage, "--nonsense", {});
    const std::string given = std::string(command->name) + " " + failing.at(command->name).arguments;
    for (const firmware::Option& option : options_of(*command)) {
      const auto* target = std::get_if<firmware::Target>(&option.target);
      if (target == nullptr || std::holds_alternative<std::string*>(*target)) continue;
      if (std::holds_alternative<std::vector<std::string>*>(*target)) continue;
      if (std::holds_alternative<std::optional<std::string>*>(*target)) continue;
      if (option.type_name == "FILE") continue;  // which may have any name
      check_refused(problem, given + " " + option.name + " many", hal::ErrorCode::usage, option.name, {"many"});
    }
  }
}

TEST_CASE("every command fails as an object under --json: wrong usage and what goes wrong later") {
  const ScratchProblem problem;
  for (const firmware::Command* command : firmware::commands()) {
    CAPTURE(command->name);
    const auto rows = options_of(*command);
    REQUIRE(std::any_of(rows.begin(), rows.end(), [](const auto& option) { return option.name == "--json"; }));
    const std::string name(command->name);
    const auto usage = error_of(run_compueye(name + " --json --nonsense", problem.folder().path()), 2);
    CHECK(usage["code"] == "usage");
    CHECK(usage["place"] == "--nonsense");
    REQUIRE(failing.contains(command->name));
    const Failing& later = failing.at(command->name);
    const auto error = error_of(run_compueye(name + " " + later.arguments + " --json", problem.folder().path()), 1);
    CHECK(error["code"] == "not found");
    CHECK(error["place"] == later.place);
    check_refused(problem, name + " " + later.arguments, hal::ErrorCode::not_found, later.place, {});
  }
}

TEST_CASE("no output of any command goes into another, and a folder is none by the name of a stream") {
  const ScratchProblem problem;
  for (const firmware::Command* command : firmware::commands()) {
    const std::string given = std::string(command->name) + " " + failing.at(command->name).arguments;
    std::vector<std::string> files;
    for (const firmware::Option& option : options_of(*command)) {
      if (option.writes == firmware::Writes::nothing || given.find(option.name) != std::string::npos) continue;
      CAPTURE(given + " " + option.name);
      const auto refused = [&](const std::string& with, std::string_view named) {
        check_refused(problem, given + with, hal::ErrorCode::usage, option.name, {std::string(named)});
      };
      if (option.writes == firmware::Writes::folder) {
        refused(" " + option.name + " -", "'-'");
        refused(" " + option.name + " /dev/stdout", "'/dev/stdout'");
        continue;
      }
      refused(" " + option.name + " -", "--json");  // which check_refused() adds
      for (const std::string& other : files) {
        const Outcome both =
            run_compueye(given + " " + other + " - " + option.name + " /dev/stdout", problem.folder().path());
        CHECK(both.exit_code == 2);
        CHECK(both.out.empty());
        CHECK(both.err.starts_with("compueye: " + option.name + ": "));
        CHECK(both.err.find(other) != std::string::npos);
        refused(" " + other + " same " + option.name + " ./same", other);
      }
      files.push_back(option.name);
    }
  }
}

TEST_CASE("a command that is no command names the nearest, as an object too") {
  const ScratchProblem problem;
  const auto error = error_of(run_compueye("simulat --json", problem.folder().path()), 2);
  CHECK(error["code"] == "usage");
  CHECK(error["sentence"].get<std::string>().find("'simulate'") != std::string::npos);
}
