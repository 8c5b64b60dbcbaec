#include "sim/sensor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/hal/error_check.hpp"

using namespace compueye;
using hal::SensorSettings;
using sim::Sensor;

namespace {

struct Frame {
  std::vector<std::int32_t> codes;
  bool saturated = false;
};

Frame digitise(const Sensor& sensor, const std::vector<double>& signals, std::uint64_t seed = 1,
               std::uint64_t frame = 0) {
  Frame result{std::vector<std::int32_t>(signals.size()), false};
  std::vector<double> scratch(signals.size());
  result.saturated = sensor.digitise(signals, seed, frame, scratch, result.codes);
  return result;
}

}  // namespace

TEST_CASE("without noise a code is the rounded level on the pedestal") {
  SensorSettings settings;
  settings.bits = 10;
  settings.full_scale = 256.0;  // one LSB is a quarter
  settings.dark_level_lsb = 20.0;
  CHECK(settings.lsb() == 0.25);
  const Sensor sensor = Sensor::create(settings).value();
  const Frame frame = digitise(sensor, {0.0, 0.1, 0.13, 0.25, 1.0, 100.0, 250.0});
  CHECK(frame.codes == std::vector<std::int32_t>{20, 20, 21, 21, 24, 420, 1020});
  CHECK_FALSE(frame.saturated);
}

TEST_CASE("levels beyond the converter are clipped and full scale is flagged") {
  SensorSettings settings;
  settings.bits = 8;
  settings.full_scale = 256.0;
  const Sensor sensor = Sensor::create(settings).value();
  CHECK(digitise(sensor, {254.4}).codes[0] == 254);
  CHECK_FALSE(digitise(sensor, {254.4}).saturated);
  CHECK(digitise(sensor, {254.6}).saturated);
  const Frame over = digitise(sensor, {1e300, 3.0});
  CHECK(over.codes == std::vector<std::int32_t>{255, 3});
  CHECK(over.saturated);
  settings.read_noise_lsb = 50.0;
  const Frame noisy = digitise(Sensor::create(settings).value(), std::vector<double>(1000, 0.0));
  CHECK(*std::min_element(noisy.codes.begin(), noisy.codes.end()) == 0);
}

TEST_CASE("read noise has the stated mean and standard deviation and is white over channels and frames") {
  SensorSettings settings;
  settings.dark_level_lsb = 1000.0;
  settings.read_noise_lsb = 5.06;
  const Sensor sensor = Sensor::create(settings).value();
  constexpr int channels = 500, frames = 200, n = channels * frames;
  double sum = 0.0, sum2 = 0.0, neighbours = 0.0, successive = 0.0;
  std::vector<double> before;
  for (std::uint64_t f = 0; f < frames; ++f) {
    const Frame frame = digitise(sensor, std::vector<double>(channels, 0.0), 3, f);
    std::vector<double> e;
    for (const std::int32_t code : frame.codes) e.push_back(code - 1000.0);
    for (std::size_t m = 0; m < e.size(); ++m) {
      sum += e[m];
      sum2 += e[m] * e[m];
      if (m > 0) neighbours += e[m] * e[m - 1];
      if (!before.empty()) successive += e[m] * before[m];
    }
    before = e;
  }
  const double variance = 5.06 * 5.06 + 1.0 / 12.0;  // rounding adds a twelfth
  CHECK(std::fabs(sum / n) < 4.0 * std::sqrt(variance / n));
  CHECK(std::fabs(sum2 / n - variance) < 4.0 * variance * std::sqrt(2.0 / n));
  CHECK(std::fabs(neighbours / n) < 4.0 * variance / std::sqrt(n));
  CHECK(std::fabs(successive / n) < 4.0 * variance / std::sqrt(n));
}

TEST_CASE("the same seed and frame give the same codes, another does not") {
  SensorSettings settings;
  settings.dark_level_lsb = 100.0;
  settings.read_noise_lsb = 5.0;
  const Sensor sensor = Sensor::create(settings).value();
  const std::vector<double> signals(64, 2.0);
  CHECK(digitise(sensor, signals, 5, 9).codes == digitise(sensor, signals, 5, 9).codes);
  CHECK(digitise(sensor, signals, 5, 9).codes != digitise(sensor, signals, 6, 9).codes);
  CHECK(digitise(sensor, signals, 5, 9).codes != digitise(sensor, signals, 5, 10).codes);
}

TEST_CASE("steps can be switched off one by one without touching the others") {
  SensorSettings settings;
  settings.dark_level_lsb = 100.0;
  settings.read_noise_lsb = 5.0;
  const std::vector<double> signals(64, 200.0);
  const Sensor both = Sensor::create(settings).value();
  Sensor sensor = both;
  REQUIRE(sensor.enable("dark level", false).has_value());
  const Frame with = digitise(both, signals), without = digitise(sensor, signals);
  for (std::size_t m = 0; m < signals.size(); ++m) CHECK(with.codes[m] - without.codes[m] == 100);
  REQUIRE(sensor.enable("read noise", false).has_value());
  for (const std::int32_t code : digitise(sensor, signals).codes) CHECK(code == 3200);
  const auto unknown = sensor.enable("shot-noise", true);
  test::check_error(unknown, hal::ErrorCode::not_found, "sensor step", {"shot-noise"});
  REQUIRE(sensor.steps().size() == 2);
  for (const auto& step : sensor.steps()) CHECK(test::names(unknown.error().sentence, step.name));
}

TEST_CASE("sensor settings out of range are refused by name") {
  const auto place = [](auto change) {
    SensorSettings settings;
    change(settings);
    const auto result = Sensor::create(settings);
    REQUIRE_FALSE(result.has_value());
    CHECK(result.error().code == hal::ErrorCode::out_of_range);
    return result.error().place;
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(place([](SensorSettings& s) { s.bits = 0; }) == "sensor.bits");
  CHECK(place([](SensorSettings& s) { s.bits = 25; }) == "sensor.bits");
  CHECK(place([](SensorSettings& s) { s.full_scale = 0.0; }) == "sensor.full_scale");
  CHECK(place([](SensorSettings& s) { s.full_scale = nan; }) == "sensor.full_scale");
  CHECK(place([](SensorSettings& s) { s.dark_level_lsb = -1.0; }) == "sensor.dark_level_lsb");
  CHECK(place([](SensorSettings& s) { s.dark_level_lsb = 65536.0; }) == "sensor.dark_level_lsb");
  CHECK(place([](SensorSettings& s) { s.read_noise_lsb = -0.1; }) == "sensor.read_noise_lsb");
  CHECK(place([](SensorSettings& s) { s.read_noise_lsb = nan; }) == "sensor.read_noise_lsb");
}
