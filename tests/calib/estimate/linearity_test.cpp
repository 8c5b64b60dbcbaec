#include "calib/estimate/linearity.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace compueye::calib;

namespace {

constexpr double full = 4095.0, dark_level = 40.0;

/// A bow by sine, which is none of the model's, of `inl` LSB in the middle.
double read_by(double value, double inl) {
  return value + inl * std::sin(std::acos(-1.0) * value / full);
}

std::vector<SplitWhite> splits_of(double inl, double noise, double drift, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> draw(0.0, 1.0);
  std::vector<SplitWhite> all;
  double lamp = 1.0;
  for (int k = 0; k < 8; ++k) {
    const double white = 3000.0, share = 0.3 + 0.05 * k;
    const auto code = [&](double light) {
      lamp *= 1.0 + drift;
      return std::vector<double>{read_by(dark_level + light * lamp, inl) + noise * draw(random)};
    };
    SplitWhite split;
    split.part = code(white * share);
    split.whole = code(white);
    split.rest = code(white * (1.0 - share));
    all.push_back(split);
  }
  return all;
}

/// Largest distance of what the table makes of codes from a straight line through black and white.
double bow_left(const std::vector<LinearityTable>& tables, double inl) {
  const auto told = [&](double value) {
    const double code = read_by(value, inl);
    return tables.empty() ? code : tables.front().straightened(code);
  };
  double most = 0.0;
  for (double share = 0.0; share <= 1.0; share += 0.05) {
    const double line = told(dark_level) + share * (told(3040.0) - told(dark_level));
    most = std::max(most, std::fabs(told(dark_level + share * 3000.0) - line));
  }
  return most;
}

}  // namespace

TEST_CASE("a converter's bow is told by light that adds up, also while the lamp drifts") {
  for (const double inl : {20.0, -12.0}) {
    CAPTURE(inl);
    const std::vector<double> black{read_by(dark_level, inl)};
    for (const double drift : {0.0, 1e-5}) {
      const auto tables = linearity_tables(splits_of(inl, 0.05, drift, 3), black, full);
      REQUIRE(tables.size() == 1);
      CHECK(bow_left({}, inl) >= 0.5 * std::fabs(inl));
      CHECK(bow_left(tables, inl) <= 0.15 * std::fabs(inl));
    }
  }
}

TEST_CASE("a straight converter gets no table from noise, and neither do splits that are too few or empty") {
  const std::vector<double> black{dark_level};
  int tables = 0;
  for (std::uint32_t seed = 0; seed < 100; ++seed)
    tables += linearity_tables(splits_of(0.0, 0.3, 0.0, seed), black, full).empty() ? 0 : 1;
  CHECK(tables <= 6);  // three standard errors of seven degrees of freedom: two in a hundred
  auto few = splits_of(20.0, 0.05, 0.0, 1);
  for (std::size_t k = 0; k < 6; ++k) few[k].whole[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(linearity_tables(few, black, full).empty());
  CHECK(linearity_tables({}, black, full).empty());
}
