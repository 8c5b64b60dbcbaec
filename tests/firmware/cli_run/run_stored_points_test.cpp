#include <doctest/doctest.h>

#include <algorithm>

#include "tests/firmware/cli_run/pareto_command.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::test;
using Json = nlohmann::json;

TEST_CASE("a deadline takes the most accurate stored point that leaves head-room, and says so") {
  const CopiedBoard board;
  const Json curves = pareto_json(board, short_sweep());
  set_processor_share(board, 1.0);
  const Json json = board.run_json({"--deadline", "10000", "--frames", "8"});
  const Json& deadline = json["deadline"];
  CHECK(deadline["chosen_by"] == "stored points");
  CHECK(deadline["fits"] == true);
  CHECK(has_note(json, "the deadline of 10000 ms is met by"));
  double least = 1e9;
  for (const Json& point : curves["points"]) least = std::min(least, nmse_of(point, 0));
  CHECK(deadline["points"][0]["nmse"].get<double>() <= least / 0.99);
  CHECK(deadline["memory_bytes"].get<int>() > 0);
  std::uint64_t frames = 0;
  for (const Json& point : deadline["points"]) frames += point["frames"].get<std::uint64_t>();
  CHECK(frames == json["frames"]["delivered"].get<std::uint64_t>());
  CHECK(deadline["steps_down"] == 0);
  CHECK(deadline["misses"] == 0);
  const std::string chosen = deadline["points"][0]["point"].get<std::string>();
  CHECK(contains(chosen, std::to_string(json["operating_point"]["iterations"].get<int>()) + " iteration"));
}

TEST_CASE("a deadline shorter than an exposure is said to be out of reach, and steps down as far as it goes") {
  const CopiedBoard board;
  static_cast<void>(pareto_json(board, short_sweep()));
  set_processor_share(board, 1.0);
  const Ended ended = board.run({"--deadline", "1", "--frames", "30", "--no-show"});
  CHECK(ended.exit_code == 0);
  CHECK(names(ended.out, "1.00"));
  CHECK(contains(ended.out, "deadline misses: 30 of 30"));
  CHECK(contains(ended.out, "stepped down"));
}

TEST_CASE("without stored points that fit a deadline is fitted by trial, and how to measure them is said") {
  const CopiedBoard board;
  const Json without = board.run_json({"--deadline", "10000", "--frames", "2"});
  CHECK(without["deadline"]["chosen_by"] == "trial");
  CHECK(has_note(without, "compueye pareto --board"));
  static_cast<void>(pareto_json(board, short_sweep()));
  const Json moved = board.run_json({"--deadline", "10000", "--frames", "2", "--distance", "31"});
  CHECK(moved["deadline"]["chosen_by"] == "trial");
  CHECK(has_note(moved, "another response"));
  set_processor_share(board, 0.64);
  const Json disturbed = board.run_json({"--deadline", "10000", "--frames", "2"});
  CHECK(disturbed["deadline"]["chosen_by"] == "trial");
  CHECK(has_note(disturbed, "processor_share 0.64"));
  const Json by_hand = board.run_json({"--deadline", "10000", "--frames", "2", "--iterations", "9"});
  CHECK(by_hand["deadline"]["chosen_by"] == "trial");
  CHECK(by_hand["deadline"]["iterations"] == 9);
  CHECK_FALSE(has_note(by_hand, "pareto"));
}

TEST_CASE("stored points that nothing can run cost a note, and the deadline is fitted by trial") {
  const CopiedBoard board;
  static_cast<void>(pareto_json(board, short_sweep()));
  nlohmann::ordered_json measured;
  change_points(board, [&](auto& json) { measured = json; });
  for (const auto& wrong : {std::pair<std::string, Json>{"iterations", 2'000'000'000},
                            {"threads", 0},
                            {"basis", "tv"},  // which omp has not
                            {"p999_ms", -1.0}}) {
    const std::string& key = wrong.first;
    const Json& value = wrong.second;
    CAPTURE(key);
    change_points(board, [&](auto& json) {
      json["processor_share"] = 1.0;
      for (auto& point : json["points"]) {
        point[key] = value;
        if (key == "basis") point["solver"] = "omp";
      }
    });
    const Json json = board.run_json({"--deadline", "10000", "--frames", "2"});
    CHECK(json["deadline"]["chosen_by"] == "trial");
    CHECK(has_note(json, key == "p999_ms" ? key : "cannot be run"));
    CHECK(json["frames"]["delivered"] == 2);
    change_points(board, [&](auto& points) { points = measured; });
  }
}
