#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "firmware/operating_points/measured_points.hpp"
#include "studies/accuracy_and_time/point_meter.hpp"

using namespace compueye::firmware;

TEST_CASE("percentiles of frame times are those of the nearest rank") {
  FrameTimes times;
  CHECK(std::isnan(times.percentile_ms(500)));
  for (int i = 2000; i >= 1; --i) times.add(i * 1'000'000LL);
  CHECK(times.count() == 2000);
  CHECK(times.percentile_ms(500) == doctest::Approx(1000.0));
  CHECK(times.percentile_ms(999) == doctest::Approx(1998.0));
  CHECK(times.percentile_ms(1000) == doctest::Approx(2000.0));
}

TEST_CASE("with few frames the 99.9th percentile is the slowest of them") {
  FrameTimes times;
  for (const int ms : {3, 9, 1, 4}) times.add(ms * 1'000'000LL);
  CHECK(times.percentile_ms(999) == doctest::Approx(9.0));
  CHECK(times.percentile_ms(500) == doctest::Approx(3.0));
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
