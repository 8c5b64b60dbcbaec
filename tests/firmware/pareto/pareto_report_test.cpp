#include "studies/accuracy_and_time/sweep_files.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/firmware/pareto/some_sweep.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::some_sweep;

TEST_CASE("the table has every level and all together, says what is missing, and each note once") {
  Sweep sweep = some_sweep({{2, 1, 0.5}, {4, 2, 0.6}, {8, 4, 0.1}});
  sweep.cut_short = "the sweep was stopped";
  sweep.notes = {"twice", "twice"};
  const std::string text = sweep_report(sweep).text();
  const auto contains = [&](const std::string& part) { return text.find(part) != std::string::npos; };
  CHECK(contains("Partial: the sweep was stopped"));
  CHECK(text.find("note: twice") == text.rfind("note: twice"));
  CHECK(contains("noise 1.00 times the board's"));
  CHECK(contains("noise 4.00 times the board's"));
  CHECK(contains("all noise levels together"));
  CHECK(contains("12 scenes (line-art, bars, seeds from 2001)"));
}
