#include "firmware/pipeline/time_histogram.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace compueye::firmware;

namespace {

/// Nearest rank, from the sorted values themselves.
std::int64_t exact(std::vector<std::int64_t> values, std::size_t percent) {
  std::sort(values.begin(), values.end());
  const std::size_t rank = std::max<std::size_t>(1, (values.size() * percent + 99) / 100);
  return values[rank - 1];
}

void check_against_exact(const std::vector<std::int64_t>& values) {
  TimeHistogram histogram;
  for (const std::int64_t v : values) histogram.add(v);
  const TimeStatistics got = histogram.statistics();
  CHECK(got.count == values.size());
  CHECK(got.min_ns == *std::min_element(values.begin(), values.end()));
  CHECK(got.max_ns == *std::max_element(values.begin(), values.end()));
  const auto near = [&](std::int64_t found, std::size_t percent) {
    const auto truth = static_cast<double>(exact(values, percent));
    CHECK(std::abs(static_cast<double>(found) - truth) <= 0.016 * truth);
  };
  near(got.median_ns, 50);
  near(got.p90_ns, 90);
  near(got.p99_ns, 99);
}

}  // namespace

TEST_CASE("an empty histogram is all zero") {
  const TimeStatistics none = TimeHistogram().statistics();
  CHECK(none.count == 0);
  CHECK(none.max_ns == 0);
}

TEST_CASE("percentiles agree with sorting, from nanoseconds to hours") {
  std::mt19937_64 random(11);
  for (const double scale : {1.0, 60.0, 1e3, 1e6, 1e9, 1e13}) {
    std::lognormal_distribution<double> spread(0.0, 1.5);
    std::vector<std::int64_t> values;
    for (int i = 0; i < 3001; ++i) values.push_back(static_cast<std::int64_t>(scale * spread(random)));
    check_against_exact(values);
  }
  check_against_exact({5});
  check_against_exact({1, 1'000'000});
  check_against_exact(std::vector<std::int64_t>(1000, 123'456'789));
}

TEST_CASE("the ends of the range are counted like any other") {
  TimeHistogram histogram;
  histogram.add(std::numeric_limits<std::int64_t>::max());
  histogram.add(std::numeric_limits<std::int64_t>::min());
  histogram.add(-1);
  histogram.add(0);
  const TimeStatistics got = histogram.statistics();
  CHECK(got.count == 4);
  CHECK(got.min_ns == 0);
  CHECK(got.median_ns == 0);
  CHECK(got.max_ns == std::numeric_limits<std::int64_t>::max());
  histogram.clear();
  CHECK(histogram.statistics().count == 0);
}
