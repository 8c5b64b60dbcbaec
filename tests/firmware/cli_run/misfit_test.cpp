#include <doctest/doctest.h>

#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("a board that is not the recorded eye's is told, and its own is not") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec");
  const auto own = board.run_json({"--frames", "40", "--lossless", "--record", file.string()});
  CHECK(own["fit"]["frames"] == 6);
  CHECK(own["fit"]["misfits"] == 0);
  CHECK(own["fit"]["least_over_noise"].get<double>() < 1.5);
  for (const auto& change : {std::pair{"acceptance_angle_deg = 8", "acceptance_angle_deg = 8.5"},
                             std::pair{"distance_mm = 30", "distance_mm = 26"},
                             std::pair{"interommatidial_angle_deg = 1.5", "interommatidial_angle_deg = 1.4"}}) {
    CAPTURE(change.second);
    const CopiedBoard other;
    other.change(change.first, change.second);
    const auto told = other.run_json({"--replay", file.string()});
    CHECK(told["fit"]["misfits"] == told["fit"]["frames"]);
    CHECK(told["fit"]["least_over_noise"].get<double>() > 3.0);
    CHECK(told["fit"]["residual_over_noise"] >= told["fit"]["least_over_noise"]);
    CHECK(contains(other.run({"--replay", file.string()}).out, "misfit: residual "));
  }
  CHECK_FALSE(contains(board.run({"--replay", file.string()}).out, "misfit"));
}

TEST_CASE("few iterations leave a large residual and are no misfit") {
  const CopiedBoard board;
  for (const char* iterations : {"1", "5", "20"}) {
    const auto run = board.run_json({"--frames", "4", "--lossless", "--iterations", iterations});
    CHECK(run["fit"]["residual_over_noise"].get<double>() > 10.0);
    CHECK(run["fit"]["misfits"] == 0);
  }
}
