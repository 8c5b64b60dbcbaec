#include "sim/pictures/built_in_scenes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/hal/error_check.hpp"

using namespace compueye;
using sim::render_built_in;

namespace {

std::ptrdiff_t lit(const hal::Image& image) {
  return std::count_if(image.pixels.begin(), image.pixels.end(), [](float p) { return p != 0.0F; });
}

double lit_share(const hal::Image& image) {
  return static_cast<double>(lit(image)) / static_cast<double>(image.pixels.size());
}

}  // namespace

TEST_CASE("every built-in scene renders at any size, within 0..1, the same for the same seed") {
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) {
    CAPTURE(scene.name);
    CHECK_FALSE(scene.description.empty());
    for (const auto& [rows, cols] :
         {std::pair{160, 160}, std::pair{16, 16}, std::pair{61, 33}, std::pair{20, 200}, std::pair{1, 1}}) {
      if (scene.name == "fig2" && std::min(rows, cols) < 16) continue;
      for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, 3ULL, 0xFFFFFFFFFFFFFFFFULL}) {
        const auto image = render_built_in(scene.name, rows, cols, seed);
        REQUIRE(image.has_value());
        CHECK(image->rows == rows);
        CHECK(image->cols == cols);
        REQUIRE(image->pixels.size() == static_cast<std::size_t>(rows * cols));
        CHECK(std::all_of(image->pixels.begin(), image->pixels.end(), [](float p) { return p >= 0.0F && p <= 1.0F; }));
        CHECK(image->pixels == render_built_in(scene.name, rows, cols, seed)->pixels);
      }
    }
    CHECK(lit(*render_built_in(scene.name, 160, 160, 0)) > 0);
  }
}

TEST_CASE("other seeds give other pictures") {
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) {
    CAPTURE(scene.name);
    std::set<std::vector<float>> pictures;
    for (std::uint64_t seed = 0; seed < 12; ++seed) pictures.insert(render_built_in(scene.name, 64, 64, seed)->pixels);
    CHECK((pictures.size() == 12) == scene.varies);
    CHECK((pictures.size() <= 2) != scene.varies);
  }
}

TEST_CASE("line art lights 23 % of the pixels, most of them fully") {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    CAPTURE(seed);
    const hal::Image image = *render_built_in("line-art", 160, 160, seed);
    CHECK(lit_share(image) > (seed == 0 ? 0.22 : 0.20));
    CHECK(lit_share(image) < (seed == 0 ? 0.24 : 0.26));
    const auto grey = std::count_if(image.pixels.begin(), image.pixels.end(), [](float p) { return p > 0 && p < 1; });
    const auto white = std::count(image.pixels.begin(), image.pixels.end(), 1.0F);
    CHECK(white > 0);
    // A stroke w wide has a rim of one grey pixel in all: lit / grey - 1/2 bounds w from below.
    CHECK(grey < 2 * lit(image) / 3);
  }
}

TEST_CASE("the phantom of seed 0 is MATLAB's") {
  // phantom(160) has 12616 non-zero values, 1946 of which are the rounding of 1 - .8 - .2.
  const hal::Image image = *render_built_in("phantom", 160, 160, 0);
  CHECK(lit(image) == 12616 - 1946);
  // Values of the table by place: rim 1, brain .2, ventricles 0, the upper ellipse .3 and its overlap with a small one.
  CHECK(image.at(7, 80) == doctest::Approx(1.0));
  CHECK(image.at(130, 50) == doctest::Approx(0.2));
  CHECK(image.at(80, 60) == 0.0F);
  CHECK(image.at(45, 80) == doctest::Approx(0.3));
  CHECK(image.at(0, 0) == 0.0F);
}

TEST_CASE("the Fig. 2 pattern has 19 pixels and is enlarged by whole factors") {
  const hal::Image pattern = *render_built_in("fig2", 16, 16, 0);
  CHECK(lit(pattern) == 19);
  const hal::Image large = *render_built_in("fig2", 48, 50, 9);
  CHECK(lit(large) == 19 * 9);
  for (int row = 0; row < 48; ++row) {
    for (int col = 0; col < 48; ++col) CHECK(large.at(row, col + 1) == pattern.at(row / 3, col / 3));
  }
  const auto small = render_built_in("fig2", 16, 15, 0);
  test::check_error(small, hal::ErrorCode::out_of_range, "scene 'fig2'", {"16x15"});
}

TEST_CASE("bars of one pixel alternate, dots are rare") {
  const hal::Image bars = *render_built_in("bars", 160, 160, 0);
  for (int col = 4; col < 30; ++col) CHECK(bars.at(20, col) == (col % 2 == 0 ? 1.0F : 0.0F));
  CHECK(lit(*render_built_in("dots", 160, 160, 4)) == 256);
}

TEST_CASE("an unknown scene is answered with the nearest name and the list") {
  const auto result = render_built_in("lineart", 16, 16, 0);
  test::Named named{"lineart", "line-art?"};
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) named.emplace_back(scene.name);
  test::check_error(result, hal::ErrorCode::not_found, "scene", named);
  CHECK(render_built_in("", 16, 16, 0).error().code == hal::ErrorCode::not_found);
}

TEST_CASE("sizes beyond the range are refused by value") {
  for (const auto& [rows, cols] : {std::pair{0, 16}, std::pair{16, -1}, std::pair{8193, 16}}) {
    const auto result = render_built_in("dots", rows, cols, 0);
    test::check_error(result, hal::ErrorCode::out_of_range, "scene 'dots'",
                      {std::to_string(rows) + "x" + std::to_string(cols)});
  }
}

TEST_CASE("the star has 36 spokes at any radius, mirrored in both axes") {
  const hal::Image star = *render_built_in("star", 400, 400, 0);
  // Round a circle of 120 pixels light changes to dark and back 36 times: the angle by which it does is counted here
  // with trigonometry, of which the picture's own code has none.
  int changes = 0;
  bool before = false;
  constexpr int steps = 3600;
  for (int k = 0; k <= steps; ++k) {
    const double angle = 2.0 * std::acos(-1.0) * (k + 0.5) / steps;
    const bool now = star.at(static_cast<int>(std::floor(200.0 + 120.0 * std::sin(angle))),
                             static_cast<int>(std::floor(200.0 + 120.0 * std::cos(angle)))) > 0.5F;
    if (k > 0 && now != before) ++changes;
    before = now;
  }
  CHECK(changes == 72);
  for (int row = 0; row < 200; row += 7) {
    for (int col = 0; col < 200; col += 3) {
      const float light = star.at(row, col), across = star.at(row, 399 - col);
      const double x = col + 0.5 - 200.0, y = row + 0.5 - 200.0;
      if (x * x + y * y > 191.0 * 191.0) continue;
      CHECK(light + across == doctest::Approx(1.0));
      CHECK(star.at(399 - row, 399 - col) == doctest::Approx(light));
    }
  }
  CHECK(star.at(0, 0) == 0.0F);
}

TEST_CASE("the slanted edge runs at 5 degrees through the middle") {
  const hal::Image edge = *render_built_in("slanted-edge", 200, 300, 0);
  const double tangent = std::tan(5.0 * std::acos(-1.0) / 180.0);
  for (int row = 0; row < edge.rows; ++row) {
    // Where it stands in a row follows from the row's sum: dark .1, light .9.
    double sum = 0.0;
    for (int col = 0; col < edge.cols; ++col) sum += static_cast<double>(edge.at(row, col));
    const double at = (0.9 * edge.cols - sum) / 0.8;
    CHECK(at == doctest::Approx(150.0 + tangent * (row + 0.5 - 100.0)).epsilon(1e-6));
  }
  CHECK(edge.at(0, 0) == doctest::Approx(0.1));
  CHECK(render_built_in("slanted-edge", 200, 300, 1)->at(0, 0) == doctest::Approx(0.9));
}

TEST_CASE("the text has letters of other sizes in every line, and other letters by seed") {
  const hal::Image chart = *render_built_in("text", 640, 640, 0);
  // A line's height is told from the rows that are inked: six runs, each shorter than the one above.
  std::vector<int> runs;
  bool inked = false;
  for (int row = 0; row < chart.rows; ++row) {
    bool any = false;
    for (int col = 0; col < chart.cols; ++col) any = any || chart.at(row, col) > 0.5F;
    if (any && !inked) runs.push_back(0);
    if (any) ++runs.back();
    inked = any;
  }
  REQUIRE(runs.size() == 6);
  for (std::size_t n = 1; n < runs.size(); ++n) CHECK(runs[n] < runs[n - 1]);
  CHECK(runs.front() == doctest::Approx(0.22 * 640 * 8.0 / 7.0).epsilon(0.03));
  CHECK(chart.pixels != render_built_in("text", 640, 640, 1)->pixels);
  CHECK(lit_share(chart) > 0.05);
  CHECK(lit_share(chart) < 0.3);
}
