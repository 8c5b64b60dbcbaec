#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"

using namespace compueye::test;
using compueye::hal::ErrorCode;

TEST_CASE("a run that cannot be checked as it asks to be is refused before its set-up") {
  const CopiedBoard board;
  const std::string eye = board.outside("a.eye").string();
  const auto usage = [&](const std::vector<std::string>& arguments, const std::string& place, const Named& named) {
    CAPTURE(place);
    check_refused(board.run_arguments(arguments), ErrorCode::usage, place, named);
  };
  usage({"--check-every", "5"}, "--check-every", {"--eye"});
  usage({"--check-every", "0", "--eye", eye}, "--check-every", {"0"});
  usage({"--check-every", "-1", "--eye", eye}, "--check-every", {"-1"});
  usage({"--check-every", "nan", "--eye", eye}, "--check-every", {"nan"});
  usage({"--check-every", "5", "--check-warm-up", "-1", "--eye", eye}, "--check-warm-up", {"-1"});
  usage({"--check-every", "5", "--eye", eye, "--light", "manual"}, "--light", {"manual"});
  usage({"--check-every", "5", "--eye", eye, "--light", "display"}, "--light", {"display"});
}

TEST_CASE("an eye that runs is checked, and the books of the run balance") {
  const CopiedBoard board("sim-8x8-built");
  const std::string eye = board.outside("a.eye").string(), plan = board.outside("p.toml").string();
  std::ofstream(plan) << "[light]\nwarm_up_s = 0.1\nsettle_ms = 60\n[levels]\ndark_frames = 16\nblack_frames = 4\n"
                         "flat_frames = 16\nramp_steps = 0\n[patterns]\ncount = 40\n";
  const Ended made =
      compueye::test::compueye({"calibrate", "--board", board.path().string(), "--eye", eye, "--plan", plan});
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const auto json = board.run_json({"--eye", eye, "--frames", "60", "--check-every", "0.2"});
  CHECK(json["checks"]["looks"].get<int>() >= 1);
  CHECK(json["checks"]["changes"] == 0);
  CHECK(json["checks"]["last"]["changed"] == false);
  const auto& frames = json["frames"];
  CHECK(frames["checked"].get<int>() > 20);
  CHECK(frames["delivered"] == 60);
  int dropped = 0;
  for (const auto& each : frames["dropped"]) dropped += each.get<int>();
  CHECK(frames["produced"] == 60 + dropped + frames["checked"].get<int>());
  CHECK(board.run_json({"--eye", eye, "--frames", "3"})["checks"].is_null());
}
