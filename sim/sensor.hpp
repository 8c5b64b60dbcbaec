#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "hal/sensor_settings.hpp"

namespace compueye::sim {

/// One frame on its way through the sensor.
struct SensorFrame {
  std::uint64_t seed = 0;
  std::uint64_t frame = 0;
  std::span<double> levels_lsb;  ///< M levels in LSB, unrounded, changed in place
};

/// An effect of the sensor: adds itself to the levels of a frame. Neither allocates nor throws, and draws from streams
/// of its own Effect only.
struct SensorStep {
  std::string_view name;
  bool enabled = true;
  void (*apply)(const hal::SensorSettings& settings, SensorFrame& frame) noexcept = nullptr;
};

/// From noise-free signals to codes: the enabled steps in order, then the converter, which always rounds and clips:
/// code = clip(round(level), 0, 2^bits - 1). New effects are new steps.
class Sensor {
 public:
  /// Steps in order: "dark level", "read noise". Errors: those of settings.validate().
  [[nodiscard]] static hal::Result<Sensor> create(const hal::SensorSettings& settings);

  [[nodiscard]] const hal::SensorSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] std::span<const SensorStep> steps() const noexcept { return steps_; }
  /// Error not_found lists the known steps.
  [[nodiscard]] hal::Result<void> enable(std::string_view step, bool enabled);

  /// Writes the codes of one frame; true when at least one channel reached the largest code. `signals`, `levels_lsb`
  /// (scratch) and `codes` have the same size. Same seed and frame, same codes. Neither allocates nor throws.
  [[nodiscard]] bool digitise(std::span<const double> signals, std::uint64_t seed, std::uint64_t frame,
                              std::span<double> levels_lsb, std::span<std::int32_t> codes) const noexcept;

 private:
  explicit Sensor(const hal::SensorSettings& settings);

  hal::SensorSettings settings_;
  std::vector<SensorStep> steps_;
};

}  // namespace compueye::sim
