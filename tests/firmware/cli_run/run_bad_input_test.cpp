#include <doctest/doctest.h>

#include <fstream>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"

using namespace compueye::test;
using compueye::hal::ErrorCode;

TEST_CASE("unknown names are answered with the nearest") {
  const CopiedBoard board;
  check_refused(board.run_arguments({"--scene", "phantm"}), ErrorCode::not_found, "scene", {"phantm", "phantom?"});
  const std::string longer = board.path().string() + "8";
  check_refused({"run", "--board", longer}, ErrorCode::not_found, longer, {board.path().string() + "?"});
  check_refused({"simulate", "--board", board.path().string(), "--scene", "bar", "--out", "y.npy"},
                ErrorCode::not_found, "scene", {"bar", "bars?"});
}

TEST_CASE("a scene file that is missing or no picture is named") {
  const CopiedBoard board;
  const auto missing = board.outside("missing.png"), text = board.outside("text.png");
  std::ofstream(text) << "not a picture";
  check_refused(board.run_arguments({"--scene", missing.string()}), ErrorCode::not_found, missing.string(), {});
  check_refused(board.run_arguments({"--scene", text.string()}), ErrorCode::bad_format, text.string(), {"PNG"});
  const auto gone = board.outside("gone.toml"), wrong = board.outside("wrong.toml");
  std::ofstream(wrong) << "[[surface]]\npicture = \"star\"\ntilt = 3\n";
  check_refused(board.run_arguments({"--scene", gone.string()}), ErrorCode::not_found, gone.string(), {});
  check_refused(board.run_arguments({"--scene", wrong.string()}), ErrorCode::not_found, wrong.string() + ":3",
                {"tilt"});
}

TEST_CASE("an output that cannot be written is refused before the set-up") {
  const CopiedBoard board;
  const auto blocked = board.outside("file");
  std::ofstream(blocked) << "a file, not a folder";
  for (const std::string option : {"--out", "--sheet", "--report"}) {
    CAPTURE(option);
    const std::string below = (blocked / "below").string();
    // A folder is asked for below the file; for a file it is the folder above that cannot be made.
    check_refused(board.run_arguments({option, below}), ErrorCode::not_found,
                  option == "--out" ? below : blocked.string(), {});
    CHECK_FALSE(std::filesystem::exists(board.cache()));
  }
}

TEST_CASE("wrong usage ends with exit code 2 and names the option and the value") {
  const CopiedBoard board;
  const auto usage = [&](const std::vector<std::string>& arguments, const std::string& place, const Named& named) {
    CAPTURE(place);
    check_refused(board.run_arguments(arguments), ErrorCode::usage, place, named);
  };
  usage({"--frames", "-1"}, "--frames", {"-1"});
  usage({"--frames", "many"}, "--frames", {"many"});
  usage({"--deadline", "0"}, "--deadline", {"0"});
  usage({"--deadline", "nan"}, "--deadline", {"nan"});
  usage({"--deadline", "5", "--lossless"}, "--deadline", {"--lossless"});
  usage({"--lambda", "-0.5"}, "--lambda", {"-0.5"});
  usage({"--sigma", "inf"}, "--sigma", {"inf"});
  usage({"--lambda", "1", "--sigma", "1"}, "--lambda", {"--sigma"});
  usage({"--iterations", "0"}, "--iterations", {"0"});
  usage({"--threads", "65"}, "--threads", {"65", "1", "64"});
  usage({"--distance", "-3"}, "--distance", {"-3"});
  usage({"--format", "npy"}, "--format", {"--out"});
  usage({"--format", "gif", "--out", "x"}, "--format", {"gif"});
  usage({"--show"}, "--show", {"--json"});
  usage({"--table", "row"}, "--table", {"--json"});
  usage({"--live", "--lossless"}, "--live", {"--lossless"});
  check_refused({"run"}, ErrorCode::usage, "--board", {});
}

TEST_CASE("what is shown or tabled does not mix with a file on standard output") {
  const CopiedBoard board;
  for (const std::string file : {"--record", "--report", "--sheet"}) {
    for (const std::vector<std::string>& told : {std::vector<std::string>{"--show"}, {"--table", "row"}}) {
      std::vector<std::string> arguments{"run", "--board", board.path().string(), file, "-"};
      arguments.insert(arguments.end(), told.begin(), told.end());
      const Ended ended = compueye::test::compueye(arguments);
      CHECK(ended.exit_code == 2);
      CHECK(ended.out.empty());
      CHECK(ended.err.starts_with("compueye: " + told.front() + ": "));
      CHECK(ended.err.find(file) != std::string::npos);
    }
  }
}

TEST_CASE("a scene that saturates the sensor is refused, because nothing would ever be delivered") {
  const CopiedBoard board;
  board.change("full_scale = 128", "full_scale = 3");
  check_refused(board.run_arguments({"--frames", "5"}), ErrorCode::mismatch,
                (board.path() / "board.toml").string() + ":26", {"40", "64", "full_scale", "3"});
}

TEST_CASE("without --json a failure is one line on stderr and nothing on stdout") {
  const CopiedBoard board;
  check_failed(board.run({"--scene", "phantm"}), ErrorCode::not_found, "scene", {"phantm", "phantom?"});
  check_failed(board.run({"--frames", "-1"}), ErrorCode::usage, "--frames", {"-1"});
  check_failed(board.run({"--format", "npy"}), ErrorCode::usage, "--format", {"--out"});
}
