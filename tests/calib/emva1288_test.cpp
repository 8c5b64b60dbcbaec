#include "calib/emva1288.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/random/random.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"
#include "tests/sim/effect_rig.hpp"

using namespace compueye;
using calib::LightSeries;
using calib::sensor_noise;
using calib::SensorNoise;

namespace {

/// The simulated detector before an even lamp: the steps of its effects, then rounding and clipping.
struct SensorBench {
  test::EffectRig rig{32, 32, 0.0};
  double lamp_noise = 0.0;  ///< relative, a draw a frame, the same for all channels
  int frames = test::sanitized ? 20 : 150;
  std::vector<LightSeries> series = {};

  explicit SensorBench(double electrons_per_lsb) {
    rig.board.sensor.bits = 12;
    rig.board.sensor.dark_level_lsb = 100.0;
    rig.board.detector.electrons_per_lsb = electrons_per_lsb;
  }

  /// `level_lsb` is what light alone delivers.
  void take(double level_lsb, double exposure_s) {
    rig.board.detector.integration_ms = exposure_s * 1e3;
    const sim::Workings w = rig.workings({"gain_spread", "dark_current", "shot_noise", "full_well", "offset_spread",
                                          "defects", "dark_level", "nonlinearity", "read_noise"},
                                         5);
    LightSeries& taken = series.emplace_back();
    taken.light = level_lsb;
    taken.exposure_s = exposure_s;
    std::vector<double> levels(1024);
    std::vector<std::int32_t> stuck(1024, -1);
    for (int f = 0; f < frames; ++f) {
      const auto frame = static_cast<std::uint64_t>(f) + 10000 * series.size();
      sim::RandomStream lamp({99, sim::Draws::picture, frame, 0});
      std::fill(levels.begin(), levels.end(), level_lsb * (1.0 + lamp_noise * lamp.gaussian()));
      sim::FrameInWork work{frame, 0.0, levels, stuck};
      for (const auto& step : w.steps) step->apply(work);
      for (std::size_t m = 0; m < levels.size(); ++m) {
        const auto code = static_cast<std::int32_t>(std::clamp(std::round(levels[m]), 0.0, 4095.0));
        taken.codes.push_back(stuck[m] >= 0 ? stuck[m] : code);
      }
    }
  }

  SensorNoise measured(double brightest_lsb, int steps = 24) {
    rig.board.frame_rate_hz = 5.0;
    series.clear();
    for (const double exposure : {0.001, 0.01, 0.1}) take(0.0, exposure);
    for (int k = 1; k <= steps; ++k) take(brightest_lsb * k / steps, 0.01);
    return sensor_noise(series, 1024, 12).value();
  }
};

void check_near(std::optional<double> told, double truth, double share) {
  REQUIRE(told.has_value());
  CAPTURE(truth);
  CHECK(std::fabs(*told / truth - 1.0) < share);
}

constexpr double slack = test::sanitized ? 4.0 : 1.0;  // of tolerances, for fewer frames

}  // namespace

TEST_CASE("the simulated detector gives back what it was told, by EMVA 1288") {
  SensorBench bench(20.0);
  bench.rig.board.sensor.read_noise_lsb = 2.0;
  bench.rig.board.detector.full_well_e = 50000.0;
  bench.rig.board.detector.dark_current_e_per_s = 40000.0;
  bench.rig.board.build.offset_spread_lsb = 3.0;
  bench.rig.board.build.gain_spread = 0.01;
  for (const double lamp_noise : {0.0, 0.001}) {
    CAPTURE(lamp_noise);
    bench.lamp_noise = lamp_noise;
    const SensorNoise noise = bench.measured(2900.0);
    check_near(noise.median.gain_lsb_per_e, 0.05, 0.015 * slack);
    // 2 LSB at 20 electrons each, and the shot noise of 1 ms of dark current.
    check_near(noise.median.read_noise_e, std::sqrt(1600.0 + 40.0), 0.03 * slack);
    check_near(noise.median.dark_current_e_per_s, 40000.0, 0.03 * slack);
    check_near(noise.dsnu_e, 60.0, 0.09);  // 1024 draws: four times 1 / sqrt 2048
    check_near(noise.prnu, 0.01, 0.09);
    // Wells of 50000 electrons less dark current's 400; series are 2417 electrons apart, and gains blur where
    // that is.
    check_near(noise.median.saturation_e, 49600.0, 0.08 * slack);
    check_near(noise.median.dynamic_range, 49600.0 / (std::sqrt(1640.0 + 33.3 + 0.25) + 0.5), 0.09 * slack);
    REQUIRE(noise.median.linearity_error.has_value());
    CHECK(*noise.median.linearity_error < 0.003 * slack);
    for (std::size_t m = 0; m < 1024; m += 101) check_near(noise.channels[m].gain_lsb_per_e, 0.05, 0.25 * slack);
  }
}

TEST_CASE("a lamp's noise that would double K is taken off what is the channels' own") {
  SensorBench bench(500.0);
  bench.rig.board.sensor.read_noise_lsb = 0.5;
  bench.rig.board.detector.full_well_e = 0.0;
  bench.lamp_noise = 0.001;
  const SensorNoise noise = bench.measured(3900.0, 16);
  check_near(noise.median.gain_lsb_per_e, 0.002, 0.02 * slack);
  // The same by one channel's variance alone, at 2681 LSB: 1.3 million electrons, a lamp's share of 1.3.
  const LightSeries& bright = bench.series[13];
  std::vector<double> codes;
  for (std::size_t n = 7; n < bright.codes.size(); n += 1024) codes.push_back(bright.codes[n]);
  const test::Moments alone = test::moments(codes);
  CHECK(alone.variance / (alone.mean - 100.0) > 1.5 * 0.002);
  // And one channel cannot tell its noise from the lamp's.
  std::vector<LightSeries> one = bench.series;
  for (LightSeries& each : one) {
    std::vector<std::int32_t> own;
    for (std::size_t n = 7; n < each.codes.size(); n += 1024) own.push_back(each.codes[n]);
    each.codes = own;
  }
  const SensorNoise single = sensor_noise(one, 1, 12).value();
  CHECK_FALSE(single.median.gain_lsb_per_e.has_value());
  CHECK_FALSE(single.median.read_noise_e.has_value());
}

TEST_CASE("a channel that blinks hides no other's noise, and few frames tell all channels' K though none's own") {
  SensorBench bench(20.0);
  bench.rig.board.sensor.read_noise_lsb = 1.0;
  bench.frames = 12;
  bench.take(0.0, 0.01);
  bench.take(2000.0, 0.01);
  std::vector<LightSeries> few;
  constexpr std::size_t channels = 64;
  for (const LightSeries& each : bench.series) {
    LightSeries& kept = few.emplace_back(LightSeries{each.light, each.exposure_s, {}});
    for (std::size_t n = 0; n < each.codes.size(); ++n) {
      if (n % 1024 < channels) kept.codes.push_back(each.codes[n]);
    }
  }
  const SensorNoise plain = sensor_noise(few, channels, 12).value();
  check_near(plain.median.gain_lsb_per_e, 0.05, 0.25);
  CHECK_FALSE(plain.dsnu_e.has_value());  // which asks for each channel's own
  for (std::size_t f = 0; f < 12; f += 3) few.back().codes[f * channels + 51] = 100;
  const SensorNoise blinking = sensor_noise(few, channels, 12).value();
  check_near(blinking.median.gain_lsb_per_e, 0.05, 0.25);
}

TEST_CASE("four channels keep three quarters of their noise, and get it back") {
  SensorBench bench(20.0);
  bench.rig.board.sensor.read_noise_lsb = 1.0;
  (void)bench.measured(3900.0, 12);
  double sum = 0.0;
  constexpr std::size_t groups = 64;
  for (std::size_t group = 0; group < groups; ++group) {
    std::vector<LightSeries> four = bench.series;
    for (LightSeries& each : four) {
      std::vector<std::int32_t> own;
      for (std::size_t n = 0; n < each.codes.size(); ++n) {
        if (n % 1024 / 4 == group) own.push_back(each.codes[n]);
      }
      each.codes = own;
    }
    const SensorNoise told = sensor_noise(four, 4, 12).value();
    for (const auto& channel : told.channels) sum += channel.gain_lsb_per_e.value_or(0.0) / (4.0 * groups);
  }
  // Not divided by 1 - 1/4 it would be 25 % too small.
  check_near(sum, 0.05, 0.03 * slack);
}

TEST_CASE("a converter's bow is the linearity error that the noise-free curve has") {
  SensorBench bench(20.0);
  bench.rig.board.detector.inl_lsb = 40.0;
  const SensorNoise noise = bench.measured(3900.0, 16);
  // 5 .. 95 % of full scale less the dark level: the line of least relative distances through the exact curve, found by
  // trying lines instead of normal equations.
  const auto curve = [](double level) {
    const double u = (level + 100.0) / 4096.0, u0 = 100.0 / 4096.0;
    return level + 160.0 * (u * (1.0 - u) - u0 * (1.0 - u0));
  };
  const double reach = 0.98 * 4095.0 - curve(0.0) - 100.0 - 160.0 * 100.0 / 4096.0 * (1.0 - 100.0 / 4096.0);
  double best = 1e9, error = 0.0;
  for (double offset = -20.0; offset < 60.0; offset += 0.1) {
    for (double slope = 0.94; slope < 1.06; slope += 0.0005) {
      double squares = 0.0, sum = 0.0;
      int points = 0;
      for (int k = 1; k <= 16; ++k) {
        const double x = 3900.0 * k / 16, y = curve(x), line = offset + slope * x;
        if (y < 0.05 * reach || y > 0.95 * reach) continue;
        squares += std::pow((y - line) / y, 2);
        sum += std::fabs(y / line - 1.0);
        ++points;
      }
      if (squares >= best) continue;
      best = squares;
      error = sum / points;
    }
  }
  REQUIRE(error > 0.002);
  check_near(noise.median.linearity_error, error, 0.1 * slack);
}

TEST_CASE("what cannot be told is not told") {
  SensorBench bench(0.0);  // light without quanta
  bench.rig.board.sensor.read_noise_lsb = 2.0;
  const SensorNoise noise = bench.measured(3900.0, 12);
  CHECK_FALSE(noise.median.gain_lsb_per_e.has_value());
  CHECK_FALSE(noise.median.read_noise_e.has_value());
  CHECK_FALSE(noise.median.saturation_e.has_value());
  CHECK_FALSE(noise.median.dynamic_range.has_value());
  CHECK_FALSE(noise.dsnu_e.has_value());
  CHECK_FALSE(noise.prnu.has_value());
  CHECK(noise.median.linearity_error.has_value());

  SensorBench dim(20.0);  // never near saturation, one dark exposure
  dim.rig.board.frame_rate_hz = 5.0;
  dim.take(0.0, 0.01);
  for (const double level : {100.0, 200.0, 300.0, 400.0}) dim.take(level, 0.01);
  const SensorNoise told = sensor_noise(dim.series, 1024, 12).value();
  check_near(told.median.gain_lsb_per_e, 0.05, 0.03 * slack);
  CHECK_FALSE(told.median.dark_current_e_per_s.has_value());
  CHECK_FALSE(told.median.saturation_e.has_value());
  CHECK_FALSE(told.median.dynamic_range.has_value());
  REQUIRE(told.prnu.has_value());
  CHECK(*told.prnu < 0.002 * slack);
  CHECK(told.dsnu_e.has_value());
}

TEST_CASE("a stuck channel tells nothing and spoils nothing") {
  SensorBench bench(20.0);
  bench.rig.board.detector.stuck = {3, 700};
  bench.rig.board.sensor.read_noise_lsb = 1.0;
  const SensorNoise noise = bench.measured(3900.0, 12);
  CHECK_FALSE(noise.channels[3].gain_lsb_per_e.has_value());
  CHECK_FALSE(noise.channels[700].gain_lsb_per_e.has_value());
  check_near(noise.median.gain_lsb_per_e, 0.05, 0.02 * slack);
  REQUIRE(noise.prnu.has_value());
  CHECK(*noise.prnu < 0.002);
}

TEST_CASE("frames that are no measurement are refused by name") {
  const LightSeries dark{0.0, 0.01, {1, 2, 1, 2}}, lit{5.0, 0.01, {9, 9, 8, 8}};
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](std::vector<LightSeries> series, int channels = 2, int bits = 12) {
    const auto result = sensor_noise(series, channels, bits);
    REQUIRE_FALSE(result.has_value());
    return result.error().code;
  };
  CHECK(sensor_noise(std::vector{dark, lit}, 2, 12).has_value());
  CHECK(refused({}) == hal::ErrorCode::usage);
  CHECK(refused({dark, lit}, 0) == hal::ErrorCode::out_of_range);
  CHECK(refused({dark, lit}, 2, 25) == hal::ErrorCode::out_of_range);
  CHECK(refused({dark, lit}, 3) == hal::ErrorCode::mismatch);
  CHECK(refused({dark, lit}, 4) == hal::ErrorCode::mismatch);
  CHECK(refused({dark}) == hal::ErrorCode::mismatch);
  CHECK(refused({lit}) == hal::ErrorCode::mismatch);
  CHECK(refused({dark, lit, {5.0, 0.02, {1, 2, 1, 2}}}) == hal::ErrorCode::mismatch);
  CHECK(refused({{0.0, 0.02, {1, 2, 1, 2}}, lit}) == hal::ErrorCode::mismatch);
  CHECK(refused({dark, {nan, 0.01, {1, 2, 1, 2}}}) == hal::ErrorCode::out_of_range);
  CHECK(refused({dark, {-1.0, 0.01, {1, 2, 1, 2}}}) == hal::ErrorCode::out_of_range);
  CHECK(refused({dark, {1.0, 0.0, {1, 2, 1, 2}}}) == hal::ErrorCode::out_of_range);
}
