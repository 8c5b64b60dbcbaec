#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "calib/patterns/pattern_family.hpp"
#include "calib/row_draws.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::calib;

namespace {

struct Size {
  int rows, cols;
  std::int64_t patterns;  // N where there is a matrix of N; else one less than the next order above N
};

constexpr std::array<Size, 8> sizes{{
    {8, 8, 64},     // Sylvester by Sylvester
    {4, 20, 80},    // Sylvester by Paley
    {4, 5, 20},     // Paley's, over all pixels
    {10, 10, 100},  // his second one, over all pixels
    {16, 16, 256},  //
    {3, 3, 11},     // cropped
    {7, 13, 95},    // cropped, beyond an order that is missing
    {1, 1, 1},
}};

std::vector<std::vector<int>> patterns_of(int rows, int cols) {
  const PatternFamily& family = **pattern_family("hadamard");
  std::vector<std::vector<int>> patterns;
  for (std::int64_t index = 0; index < family.count(rows, cols); ++index) {
    const auto image = family.draw(rows, cols, 0, index);
    REQUIRE(image.has_value());
    std::vector<int> lit;
    for (const float pixel : image->pixels) {
      REQUIRE((pixel == 0.0F || pixel == 1.0F));
      lit.push_back(pixel == 1.0F ? 1 : 0);
    }
    patterns.push_back(std::move(lit));
  }
  return patterns;
}

}  // namespace

TEST_CASE("hadamard patterns: the inverse of the S-matrix gives every pixel back, in whole numbers") {
  for (const Size& size : sizes) {
    CAPTURE(size.rows);
    CAPTURE(size.cols);
    const auto patterns = patterns_of(size.rows, size.cols);
    const auto pixels = static_cast<std::size_t>(size.rows * size.cols);
    REQUIRE(static_cast<std::int64_t>(patterns.size()) == size.patterns);
    const bool with_all_on = patterns.size() == pixels;
    const auto order = static_cast<std::int64_t>(patterns.size()) + (with_all_on ? 0 : 1);

    RowDraws draws(3, 0);
    std::vector<std::int64_t> scene, seen;
    for (std::size_t n = 0; n < pixels; ++n) scene.push_back(static_cast<std::int64_t>(draws.next_bits() >> 44));
    for (const auto& pattern : patterns) {
      std::int64_t sum = 0;
      for (std::size_t n = 0; n < pixels; ++n) sum += pattern[n] * scene[n];
      seen.push_back(sum);
    }
    // Harwit & Sloane: the inverse of S of order n - 1 is 2/n (2 S' - J).
    std::int64_t all = 0;
    for (std::size_t n = with_all_on ? 1 : 0; n < pixels; ++n) {
      std::int64_t sum = 0;
      for (std::size_t p = with_all_on ? 1 : 0; p < patterns.size(); ++p) sum += (2 * patterns[p][n] - 1) * seen[p];
      CHECK(2 * sum == order * scene[n]);
      all += scene[n];
    }
    if (with_all_on) CHECK(seen[0] - all == scene[0]);
  }
}

TEST_CASE("hadamard patterns: half of what a pattern can light is lit") {
  for (const Size& size : sizes) {
    CAPTURE(size.rows);
    CAPTURE(size.cols);
    const auto patterns = patterns_of(size.rows, size.cols);
    const auto pixels = static_cast<std::size_t>(size.rows * size.cols);
    const bool whole = patterns.size() == pixels;
    std::vector<std::size_t> times(pixels, 0);
    for (std::size_t p = 0; p < patterns.size(); ++p) {
      std::size_t lit = 0;
      for (std::size_t n = 0; n < pixels; ++n) {
        lit += static_cast<std::size_t>(patterns[p][n]);
        times[n] += static_cast<std::size_t>(patterns[p][n]);
      }
      if (whole) CHECK(lit == (p == 0 ? pixels : pixels / 2));
    }
    for (std::size_t n = whole ? 1 : 0; n < pixels; ++n) {
      CHECK(times[n] == (whole ? pixels / 2 + 1 : (patterns.size() + 1) / 2));
    }
  }
}

TEST_CASE("hadamard patterns: 25600 of 160x160 are separable, and those looked at are orthogonal") {
  const PatternFamily& family = **pattern_family("hadamard");
  REQUIRE(family.count(160, 160) == 25600);
  const int looked_at = test::sanitized ? 8 : 48;
  std::vector<std::vector<int>> signs;
  for (int k = 0; k < looked_at; ++k) {
    const auto image = *family.draw(160, 160, 0, k < 4 ? 25599 - k : 1 + (k * 25601LL) % 25599);
    std::vector<int> row;
    int sum = 0;
    for (const float pixel : image.pixels) {
      row.push_back(pixel == 1.0F ? -1 : 1);
      sum += row.back();
    }
    CHECK(sum == 0);
    int not_of_rank_one = 0;
    for (int r = 0; r < 160; ++r) {
      for (int c = 0; c < 160; ++c) {
        const auto at = [&](int i, int j) { return row[image.index(i, j)]; };
        not_of_rank_one += at(r, c) * at(0, 0) == at(r, 0) * at(0, c) ? 0 : 1;
      }
    }
    CHECK(not_of_rank_one == 0);
    signs.push_back(std::move(row));
  }
  for (std::size_t a = 0; a < signs.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      int product = 0;
      for (std::size_t n = 0; n < signs[a].size(); ++n) product += signs[a][n] * signs[b][n];
      CHECK(product == 0);
    }
  }
}
