#include "sim/pictures/built_in_scenes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
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
  for (const char* name : {"line-art", "phantom", "bars", "dots"}) {
    CAPTURE(name);
    std::set<std::vector<float>> pictures;
    for (std::uint64_t seed = 0; seed < 12; ++seed) pictures.insert(render_built_in(name, 64, 64, seed)->pixels);
    CHECK(pictures.size() == 12);
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
