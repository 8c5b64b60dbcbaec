#include <doctest/doctest.h>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

/// As noisy as the samples are bright, where the rule's lambda is far too small.
struct NoisyBoard : CopiedBoard {
  NoisyBoard() {
    change("read_noise_lsb = 1", "read_noise_lsb = 5000");
    change("dark_level_lsb = 64", "dark_level_lsb = 30000");
    change("basis = \"identity\"", "basis = \"dct\"");
  }
};

std::vector<std::string> noisy_run(const std::vector<std::string>& more) {
  std::vector<std::string> all{"--lossless", "--frames", "4", "--scene", "line-art"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

TEST_CASE("lambda from the samples is better than the rule's where noise is large, always the same, and told") {
  const NoisyBoard board;
  const auto rule = board.run_json(noisy_run({}));
  const auto risk = board.run_json(noisy_run({"--lambda-from-samples"}));
  CHECK(rule["operating_point"]["lambda_by"] == "rule");
  CHECK(rule["operating_point"]["lambda_over_rule"] == 1.0);
  const auto& point = risk["operating_point"];
  CHECK(point["lambda_by"] == "samples");
  CHECK(point["rule_lambda"] == rule["operating_point"]["lambda"]);
  CHECK(point["lambda_over_rule"].get<double>() >= 4.0);
  CHECK(point["lambda"].get<double>() ==
        doctest::Approx(point["lambda_over_rule"].get<double>() * point["rule_lambda"].get<double>()));
  CHECK(risk["quality"]["nmse"].get<double>() < 0.7 * rule["quality"]["nmse"].get<double>());
  CHECK(board.run_json(noisy_run({"--lambda-from-samples"}))["operating_point"]["lambda"] == point["lambda"]);
  CHECK(contains(board.run(noisy_run({"--lambda-from-samples"})).out, "from the samples"));
}

TEST_CASE("a replay makes its run's pictures with its lambda, unless told otherwise") {
  const NoisyBoard board;
  const auto file = board.outside("eye.rec");
  const auto pictures = [&](const std::string& name, std::vector<std::string> more) {
    const auto folder = board.outside(name);
    more.insert(more.end(), {"--out", folder.string(), "--format", "npy"});
    const auto json = board.run_json(more);
    return std::pair{bytes_of(folder / "frames.npy"), json["operating_point"]};
  };
  const auto [live, chosen] = pictures("live", noisy_run({"--lambda-from-samples", "--record", file.string()}));
  const auto [again, recorded] = pictures("again", {"--replay", file.string()});
  CHECK(again == live);
  CHECK(recorded["lambda_by"] == "recording");
  CHECK(recorded["lambda"] == chosen["lambda"]);
  const auto [by_rule, rule] = pictures("rule", {"--replay", file.string(), "--lambda-by-rule"});
  CHECK(by_rule != live);
  CHECK(rule["lambda"] == chosen["rule_lambda"]);
  // Another problem has another lambda.
  const auto [other, louder] = pictures("louder", {"--replay", file.string(), "--sigma", "20"});
  CHECK(louder["lambda_by"] == "rule");
}

TEST_CASE("lambda from the samples of a recording is that of its first frame that tells") {
  const NoisyBoard board;
  const auto file = board.outside("eye.rec");
  board.run_json(noisy_run({"--record", file.string()}));
  const auto live = board.run_json(noisy_run({"--lambda-from-samples"}));
  const auto replayed = board.run_json({"--replay", file.string(), "--lambda-from-samples"});
  CHECK(replayed["operating_point"]["lambda_by"] == "samples");
  CHECK(replayed["operating_point"]["lambda"] == live["operating_point"]["lambda"]);
}

TEST_CASE("where the samples do not tell, lambda stays the rule's, and a note says why") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec");
  board.run_json({"--frames", "4", "--lossless", "--record", file.string()});
  const auto stays = [&](const CopiedBoard& on, std::vector<std::string> more, const std::string& why) {
    more.insert(more.end(), {"--replay", file.string(), "--lambda-from-samples"});
    const auto json = on.run_json(more);
    CAPTURE(json["notes"].dump());
    CHECK(json["operating_point"]["lambda_by"] == "rule");
    CHECK(json["operating_point"]["lambda_over_rule"] == 1.0);
    CHECK(names(json["notes"].dump(), why));
  };
  const CopiedBoard nearer;
  nearer.change("distance_mm = 30", "distance_mm = 26");
  stays(nearer, {}, "residual");
  stays(board, {"--sigma", "100"}, "4");
}

TEST_CASE("lambda by hand leaves the samples nothing to choose") {
  const CopiedBoard board;
  check_refused(board.run_arguments({"--lambda", "1", "--lambda-from-samples"}), hal::ErrorCode::usage, "--lambda",
                {"--lambda-from-samples"});
  board.change("iterations = 200", "iterations = 200\nlambda = 0.25");
  const auto json = board.run_json({"--frames", "1", "--lossless", "--lambda-from-samples"});
  CHECK(json["operating_point"]["lambda_by"] == "hand");
  CHECK(json["operating_point"]["lambda"] == 0.25);
  CHECK(json["operating_point"]["rule_lambda"].is_null());
}
