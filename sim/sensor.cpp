#include "sim/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "sim/random.hpp"

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

Result<void> check(bool ok, std::string_view field, double value, std::string_view expected) {
  if (ok) return {};
  return fail(ErrorCode::out_of_range, std::string(field),
              "is " + std::to_string(value) + ", expected " + std::string(expected));
}

void add_dark_level(const SensorSettings& settings, SensorFrame& frame) noexcept {
  for (double& level : frame.levels_lsb) level += settings.dark_lsb;
}

void add_read_noise(const SensorSettings& settings, SensorFrame& frame) noexcept {
  if (settings.read_noise_lsb == 0.0) return;
  for (std::size_t channel = 0; channel < frame.levels_lsb.size(); ++channel) {
    RandomStream random({frame.seed, Effect::read_noise, frame.frame, static_cast<std::uint32_t>(channel)});
    frame.levels_lsb[channel] += settings.read_noise_lsb * random.gaussian();
  }
}

}  // namespace

double SensorSettings::lsb() const noexcept {
  return full_scale / std::ldexp(1.0, bits);
}

Result<void> SensorSettings::validate() const {
  return check(bits >= 1 && bits <= 24, "sensor.bits", bits, "1 to 24")
      .and_then([&] {
        return check(std::isfinite(full_scale) && full_scale > 0.0, "sensor.full_scale", full_scale, "more than 0");
      })
      .and_then([&] {
        return check(dark_lsb >= 0.0 && dark_lsb < std::ldexp(1.0, bits), "sensor.dark_lsb", dark_lsb,
                     "0 or more and below 2^bits");
      })
      .and_then([&] {
        return check(std::isfinite(read_noise_lsb) && read_noise_lsb >= 0.0, "sensor.read_noise_lsb", read_noise_lsb,
                     "0 or more");
      });
}

Sensor::Sensor(const SensorSettings& settings)
    : settings_(settings), steps_{{"dark level", true, add_dark_level}, {"read noise", true, add_read_noise}} {}

Result<Sensor> Sensor::create(const SensorSettings& settings) {
  return settings.validate().map([&] { return Sensor(settings); });
}

Result<void> Sensor::enable(std::string_view step, bool enabled) {
  const auto found = std::find_if(steps_.begin(), steps_.end(), [&](const SensorStep& s) { return s.name == step; });
  if (found != steps_.end()) {
    found->enabled = enabled;
    return {};
  }
  std::string known;
  for (const SensorStep& s : steps_) known += (known.empty() ? "" : ", ") + std::string(s.name);
  return fail(ErrorCode::not_found, "sensor step", "'" + std::string(step) + "' is not one of " + known);
}

bool Sensor::digitise(std::span<const double> signals, std::uint64_t seed, std::uint64_t frame,
                      std::span<double> levels_lsb, std::span<std::int32_t> codes) const noexcept {
  const double lsb = settings_.lsb();
  for (std::size_t m = 0; m < signals.size(); ++m) levels_lsb[m] = signals[m] / lsb;
  SensorFrame passing{seed, frame, levels_lsb};
  for (const SensorStep& step : steps_) {
    if (step.enabled) step.apply(settings_, passing);
  }
  const std::int32_t largest = settings_.largest_code();
  bool saturated = false;
  for (std::size_t m = 0; m < codes.size(); ++m) {
    codes[m] = static_cast<std::int32_t>(std::clamp(std::round(levels_lsb[m]), 0.0, static_cast<double>(largest)));
    saturated = saturated || codes[m] == largest;
  }
  return saturated;
}

}  // namespace compueye::sim
