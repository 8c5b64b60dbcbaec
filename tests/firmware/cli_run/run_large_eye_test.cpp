#include <doctest/doctest.h>

#include <cstdio>

#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye::test;

TEST_CASE("the 80x80 eye shows line art as well as promised, far better than a conventional eye") {
#if defined(NDEBUG) && !defined(COMPUEYE_NO_MULTIVERSION)
  const CopiedBoard board("sim-80x80");
  const auto json = board.run_json({"--frames", "1", "--lossless"});
  CHECK(json["scene"] == "line-art");
  CHECK(json["eye"]["blind_ommatidia"] == 1836);
  CHECK(json["operating_point"]["lambda_by_rule"] == true);
  // Of which the entries of A are 108 MB, held once.
  CHECK(json["memory"]["setup_peak_bytes"].get<double>() <= 200e6);
  CHECK(json["memory"]["setup_peak_bytes"].get<double>() >= 108e6);
  CHECK(json["quality"]["nmse"].get<double>() <= 0.15);
  CHECK(json["conventional"]["nmse"].get<double>() >= 0.35);
  CHECK(json["conventional"]["nmse"].get<double>() <= 0.6);
#else
  std::puts("SKIPPED: takes minutes without optimisation or with a sanitizer");
#endif
}
