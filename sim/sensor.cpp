#include "sim/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "sim/random/random.hpp"

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;
using hal::SensorSettings;

void add_dark_level(const SensorSettings& settings, SensorFrame& frame) noexcept {
  for (double& level : frame.levels_lsb) level += settings.dark_level_lsb;
}

void add_read_noise(const SensorSettings& settings, SensorFrame& frame) noexcept {
  if (settings.read_noise_lsb == 0.0) return;
  for (std::size_t channel = 0; channel < frame.levels_lsb.size(); ++channel) {
    RandomStream random({frame.seed, Draws::read_noise, frame.frame, static_cast<std::uint32_t>(channel)});
    frame.levels_lsb[channel] += settings.read_noise_lsb * random.gaussian();
  }
}

}  // namespace

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
