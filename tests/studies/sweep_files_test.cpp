#include "studies/accuracy_and_time/gnuplot_script.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "studies/accuracy_and_time/sweep_files.hpp"
#include "tests/firmware/pareto/some_sweep.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::some_sweep;
using recon::BasisKind;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("curves with efficient points come first, then the nearest; the first eight are named") {
  const Sweep sweep = some_sweep({{2, 1, 0.5, BasisKind::dct},
                                  {4, 2, 0.4, BasisKind::dct},
                                  {2, 1.1, 0.9, BasisKind::tv},
                                  {2, 9, 9.0, BasisKind::haar},
                                  {9, 8, 0.1, BasisKind::db4}});
  const auto curves = plot_curves(sweep, 0);
  REQUIRE(curves.size() == 4);
  CHECK(curves[0].title == "admm dct");
  CHECK(curves[0].points == std::vector<std::size_t>{0, 1});
  CHECK(curves[1].title == "admm db4");
  CHECK(curves[2].title == "admm tv");
  CHECK(curves[3].title == "admm haar");
  for (const PlotCurve& curve : curves) CHECK(curve.named);
}

TEST_CASE("a warm start on a still scene is drawn, but not efficient") {
  Sweep sweep = some_sweep({{2, 1, 0.5}, {4, 0.5, 0.01}, {8, 2, 0.2}});
  sweep.points[1].curve.motion = Motion::still;
  CHECK(efficient_points(sweep, 0) == std::vector<std::size_t>{0, 2});
  CHECK(plot_curves(sweep, 0).size() == 2);
}

TEST_CASE("the script has axes with units, a legend, the conventional eye and both pictures") {
  Sweep sweep = some_sweep({{2, 1, 0.5}, {4, 2, 0.0}});
  sweep.board = "it's";
  const std::string script = gnuplot_script(sweep, 1, "pareto-noise-4");
  for (const char* part : {"set logscale xy", "(ms)", "mean NMSE", "'it''s: ", "conventional eye", "'admm dct'",
                           "pareto-noise-4.svg.partial", "pareto-noise-4.png.partial", "1e-09"}) {
    CAPTURE(part);
    CHECK(contains(script, part));
  }
  sweep.conventional.clear();
  CHECK_FALSE(contains(gnuplot_script(sweep, 0, "x"), "conventional"));
}

TEST_CASE("the CSV has a line for every point and level") {
  const Sweep sweep = some_sweep({{2, 1, 0.5}, {4, 2, 0.6}, {8, 4, 0.1}});
  const std::string csv = sweep_csv(sweep);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 2 + 3 * 3);
  const std::string header = csv.substr(0, csv.find('\r'));
  const auto commas = std::count(header.begin(), header.end(), ',');
  for (std::size_t at = 0; at < csv.size();) {
    const std::size_t end = csv.find('\n', at);
    std::string line = csv.substr(at, end - at);
    bool quoted = false;
    std::ptrdiff_t fields = 0;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted) ++fields;
    }
    CHECK(fields == commas);
    at = end + 1;
  }
}
