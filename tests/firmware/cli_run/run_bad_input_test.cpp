#include <doctest/doctest.h>

#include <fstream>

#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye::test;

namespace {

/// Fails with this exit code and one sentence on stderr that has these words.
void refuses(const Ended& ended, int exit_code, const std::vector<std::string>& words) {
  CAPTURE(ended.err);
  CHECK(ended.exit_code == exit_code);
  CHECK(ended.out.empty());
  CHECK(ended.err.rfind("compueye: ", 0) == 0);
  CHECK(lines(ended.err) == 1);
  for (const std::string& word : words) CHECK_MESSAGE(contains(ended.err, word), word);
}

}  // namespace

TEST_CASE("unknown names are answered with the nearest") {
  const CopiedBoard board;
  refuses(board.run({"--scene", "phantm"}), 1, {"'phantm'", "did you mean 'phantom'"});
  refuses(compueye::test::compueye({"run", "--board", board.path().string() + "8"}), 1, {"did you mean", "sim-8x8"});
  refuses(compueye::test::compueye({"simulate", "--board", board.path().string(), "--scene", "bar", "--out", "y.npy"}),
          1, {"did you mean 'bars'"});
}

TEST_CASE("a scene file that is missing or no picture is named") {
  const CopiedBoard board;
  const auto missing = board.outside("missing.png"), text = board.outside("text.png");
  std::ofstream(text) << "not a picture";
  refuses(board.run({"--scene", missing.string()}), 1, {missing.string()});
  refuses(board.run({"--scene", text.string()}), 1, {text.string()});
  refuses(board.run({"--scene", "scene.toml"}), 1, {"scene.toml", "not", "PNG"});
}

TEST_CASE("an output that cannot be written is refused before the set-up") {
  const CopiedBoard board;
  const auto blocked = board.outside("file");
  std::ofstream(blocked) << "a file, not a folder";
  for (const std::string option : {"--out", "--sheet", "--report"}) {
    CAPTURE(option);
    refuses(board.run({option, (blocked / "below").string()}), 1, {blocked.string()});
    CHECK_FALSE(std::filesystem::exists(board.cache()));
  }
}

TEST_CASE("wrong usage ends with exit code 2 and names the option and the value") {
  const CopiedBoard board;
  const auto usage = [&](const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
    refuses(board.run(arguments), 2, words);
  };
  usage({"--frames", "-1"}, {"--frames", "-1"});
  usage({"--frames", "many"}, {"--frames", "many"});
  usage({"--deadline", "0"}, {"--deadline"});
  usage({"--deadline", "nan"}, {"--deadline", "nan"});
  usage({"--deadline", "5", "--lossless"}, {"--deadline", "--lossless"});
  usage({"--lambda", "-0.5"}, {"--lambda", "-0.5"});
  usage({"--sigma", "inf"}, {"--sigma", "inf"});
  usage({"--lambda", "1", "--sigma", "1"}, {"--lambda", "--sigma"});
  usage({"--iterations", "0"}, {"--iterations", "0"});
  usage({"--threads", "65"}, {"--threads", "65", "1 to 64"});
  usage({"--distance", "-3"}, {"--distance"});
  usage({"--format", "npy"}, {"--format", "--out"});
  usage({"--format", "gif", "--out", "x"}, {"gif"});
  usage({"--live", "--lossless"}, {"--lossless", "--live"});
  refuses(compueye::test::compueye({"run"}), 2, {"--board"});
}

TEST_CASE("a scene that saturates the sensor is refused, because nothing would ever be delivered") {
  const CopiedBoard board;
  board.change("full_scale = 128", "full_scale = 3");
  refuses(board.run({"--frames", "5"}), 1, {"board.toml:", "full_scale", "saturate"});
}

TEST_CASE("with --json a failure is an object on stdout too") {
  const CopiedBoard board;
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string code, place;
  };
  for (const Case& each : {Case{{"--scene", "phantm"}, 1, "not found", "scene"}, Case{{"--show"}, 2, "usage", "--show"},
                           Case{{"--table", "row"}, 2, "usage", "--table"}}) {
    auto arguments = each.arguments;
    arguments.emplace_back("--json");
    const Ended ended = board.run(arguments);
    CAPTURE(ended.out);
    CHECK(ended.exit_code == each.exit_code);
    CHECK(lines(ended.err) == 1);
    const auto json = nlohmann::json::parse(ended.out, nullptr, false);
    REQUIRE_FALSE(json.is_discarded());
    CHECK(json["error"]["code"] == each.code);
    CHECK(json["error"]["place"] == each.place);
    CHECK(contains(ended.err, json["error"]["sentence"].get<std::string>()));
  }
}
