#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "firmware/operating_points/measured_points.hpp"

using namespace compueye::firmware;

namespace {

using Front = std::vector<std::size_t>;

Front front_of(const std::vector<CostAndError>& points, double least_gain = 0.0) {
  return efficient_front(points, least_gain);
}

}  // namespace

TEST_CASE("what another outdoes in time and error is no efficient point") {
  CHECK(front_of({{1, 5}, {2, 6}, {3, 4}, {4, 4.5}, {5, 1}}) == Front{0, 2, 4});
  CHECK(front_of({{5, 1}, {4, 4.5}, {3, 4}, {2, 6}, {1, 5}}) == Front{4, 2, 0});
  CHECK(front_of({}).empty());
  CHECK(front_of({{7, 7}}) == Front{0});
}

TEST_CASE("of points that are equal in both the first counts, of those equal in one the better") {
  CHECK(front_of({{1, 2}, {1, 2}}) == Front{0});
  CHECK(front_of({{1, 3}, {1, 2}}) == Front{1});
  CHECK(front_of({{2, 3}, {1, 3}}) == Front{1});
}

TEST_CASE("a point that was not measured is never efficient and outdoes nobody") {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  CHECK(front_of({{nan, 0}, {0, nan}, {inf, 0}, {0, inf}, {1, 1}, {2, 0.5}}) == Front{4, 5});
  CHECK(front_of({{nan, nan}}).empty());
}

TEST_CASE("a slower point must be worth its time") {
  const std::vector<CostAndError> points{{1, 1.0}, {2, 0.995}, {3, 0.98}, {4, 0.975}};
  CHECK(front_of(points) == Front{0, 1, 2, 3});
  CHECK(front_of(points, 0.01) == Front{0, 2});
}

TEST_CASE("along a front of many points time rises and error falls") {
  std::vector<CostAndError> points;
  unsigned state = 12345;
  const auto draw = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) / 16777216.0;
  };
  for (int i = 0; i < 2000; ++i) points.push_back({draw(), draw()});
  const Front front = front_of(points);
  REQUIRE(front.size() > 3);
  for (std::size_t f = 1; f < front.size(); ++f) {
    CHECK(points[front[f]].cost > points[front[f - 1]].cost);
    CHECK(points[front[f]].error < points[front[f - 1]].error);
  }
  for (const CostAndError& p : points) {
    bool reached = false;
    for (const std::size_t f : front) reached = reached || (points[f].cost <= p.cost && points[f].error <= p.error);
    CHECK(reached);
  }
}

TEST_CASE("nine in ten is counted on the bad side of each figure") {
  std::vector<PictureQuality> pictures;
  for (int i = 1; i <= 20; ++i) pictures.push_back({0.01 * i, 40.0 - i, 1.0 - 0.01 * i});
  const QualitySummary summary = summarise(pictures);
  CHECK(summary.mean.nmse == doctest::Approx(0.105));
  CHECK(summary.mean.psnr_db == doctest::Approx(29.5));
  CHECK(summary.nine_in_ten.nmse == doctest::Approx(0.18));
  CHECK(summary.nine_in_ten.psnr_db == doctest::Approx(22.0));
  CHECK(summary.nine_in_ten.ssim == doctest::Approx(0.82));
  const std::vector<PictureQuality> one{{0.5, 3.0, 0.25}};
  CHECK(summarise(one).nine_in_ten.nmse == 0.5);
}
